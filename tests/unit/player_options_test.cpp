// SPDX-License-Identifier: Apache-2.0
// The player's command line: what it means and what it refuses.
#include <gtest/gtest.h>

#include <sstream>

#include "player/options.h"

namespace chandelier::player {
namespace {

Parsed parse(const std::string& line) {
  std::istringstream words(line);
  return parse_options({std::istream_iterator<std::string>(words), std::istream_iterator<std::string>()});
}

Options accepted(const std::string& line) {
  const Parsed parsed = parse(line);
  EXPECT_TRUE(parsed.options) << line << ": " << parsed.text;
  return parsed.options.value_or(Options{});
}

void expect_refused(const std::string& line, const std::string& because) {
  const Parsed parsed = parse(line);
  EXPECT_FALSE(parsed.options) << line;
  EXPECT_EQ(parsed.exit_code, 2) << line;
  EXPECT_NE(parsed.text.find(because), std::string::npos) << line << ": " << parsed.text;
  EXPECT_EQ(parsed.text.find('\n'), std::string::npos) << "more than one line: " << parsed.text;
}

std::string stage_answer(const Recipe& recipe, std::string_view stage) {
  for (size_t i = 0; i < stage_choices().size(); ++i)
    if (stage_choices()[i].stage == stage) return std::string(answer(recipe, i));
  return "no such stage";
}

TEST(PlayerOptions, OutputMeansHeadlessAndNoneMeansAWindow) {
  EXPECT_EQ(accepted("scene.chandelier --output a.png").mode, Mode::headless);
  EXPECT_EQ(accepted("scene.chandelier --output a.PFM").mode, Mode::headless);
  EXPECT_EQ(accepted("scene.chandelier").mode, Mode::window);
  EXPECT_EQ(accepted("--list-devices").mode, Mode::list_devices);
}

TEST(PlayerOptions, Defaults) {
  const Options options = accepted("scene.chandelier --output a.png");
  EXPECT_EQ(options.width, 1280u);
  EXPECT_EQ(options.height, 720u);
  EXPECT_FALSE(options.frames);
  EXPECT_FALSE(options.exposure_ev);
  EXPECT_FALSE(options.camera);
  ASSERT_EQ(options.recipes.size(), 1u);
  EXPECT_EQ(options.recipes[0].preset, "reference");
  EXPECT_EQ(stage_answer(options.recipes[0].recipe, "select"), "per-light");
}

TEST(PlayerOptions, TheHeadlightIsLeftToThePackUnlessAsked) {
  EXPECT_FALSE(accepted("scene.chandelier").headlight);
  EXPECT_FALSE(accepted("scene.chandelier --headlight auto").headlight);
  EXPECT_EQ(accepted("scene.chandelier --headlight on").headlight, headlight_on);
  EXPECT_EQ(accepted("scene.chandelier --headlight off").headlight, 0.0f);
  EXPECT_EQ(accepted("scene.chandelier --headlight 2.5").headlight, 2.5f);
  for (const char* wrong : {"bright", "-1", "nan", "1e7"})
    expect_refused(std::string("scene.chandelier --headlight ") + wrong,
                   std::string("--headlight: must be auto, on, off or a strength from 0 to 1e6 (") + wrong + ")");
}

TEST(PlayerOptions, AmbientIsOneRadianceOrTwo) {
  EXPECT_TRUE(accepted("scene.chandelier").ambient.is_dark());
  EXPECT_EQ(accepted("scene.chandelier --ambient 2.5").ambient, Ambient::constant(2.5f));
  EXPECT_EQ(accepted("scene.chandelier --ambient 3,0.5").ambient, Ambient::between(3.0f, 0.5f));
  EXPECT_EQ(accepted("scene.chandelier --ambient 0,1").ambient, Ambient::between(0.0f, 1.0f));
  EXPECT_EQ(accepted("scene.chandelier --ambient 0.7,0.7").ambient, Ambient::constant(0.7f));
  for (const char* wrong : {"bright", "-1", "nan", "1e7", "1,", ",1", ",", "1,nan", "1,-1", "1,2,3", "1;2", "inf,1"})
    expect_refused(std::string("scene.chandelier --ambient ") + wrong,
                   std::string("--ambient: must be a radiance from 0 to 1e6, or two as UP,DOWN (") + wrong + ")");
}

TEST(PlayerOptions, EveryAnswerOfEveryStageIsAnOption) {
  for (const StageChoices& choices : stage_choices())
    for (const auto& [chosen, meaning] : choices.answers) {
      const std::string option = "--" + std::string(choices.stage) + " " + std::string(chosen);
      const Parsed parsed = parse("scene.chandelier --output a.png " + option);
      if (!parsed.options) {  // only refusal() may object
        EXPECT_NE(parsed.text.find("preset reference: "), std::string::npos) << parsed.text;
        continue;
      }
      EXPECT_EQ(stage_answer(parsed.options->recipes[0].recipe, choices.stage), chosen) << option;
    }
}

TEST(PlayerOptions, ExplicitSettingsOverrideThePreset) {
  const Options options = accepted(
      "scene.chandelier --output a.png --preset lightcluster --filter pcf --cull none --d-init 0.25 --z-far 12 "
      "--distance-scaling "
      "paper-formula --dynamic-lights own --area-radius spread --stability 0.25 --face-size 128 --shadow-budget 64 "
      "--ambient 0.5 --exposure -1.5 --frames 7 --size 64x32");
  const Recipe& recipe = options.recipes.at(0).recipe;
  EXPECT_EQ(stage_answer(recipe, "select"), "light-clusters");
  EXPECT_EQ(stage_answer(recipe, "filter"), "pcf");
  EXPECT_EQ(stage_answer(recipe, "cull"), "none");
  EXPECT_FLOAT_EQ(recipe.d_init_m, 0.25f);
  EXPECT_FLOAT_EQ(recipe.z_far_m, 12.0f);
  EXPECT_EQ(recipe.distance_scaling, DistanceScaling::paper_formula);
  EXPECT_EQ(recipe.dynamic_lights, DynamicLights::own);
  EXPECT_EQ(recipe.area_radius, AreaRadius::spread);
  EXPECT_FLOAT_EQ(recipe.stability, 0.25f);
  EXPECT_EQ(recipe.face_size_px, 128u);
  EXPECT_EQ(recipe.shadow_budget_bytes, uint64_t{64} << 20);
  EXPECT_EQ(options.ambient, Ambient::constant(0.5f));
  EXPECT_FLOAT_EQ(options.exposure_ev.value(), -1.5f);
  EXPECT_EQ(options.frames, 7u);
  EXPECT_EQ(options.width, 64u);
  EXPECT_EQ(options.height, 32u);
}

TEST(PlayerOptions, SettingsApplyToBothSidesOfAComparison) {
  const Options options = accepted("scene.chandelier --compare reference,lightcluster --report r --face-size 256");
  EXPECT_EQ(options.mode, Mode::compare);
  ASSERT_EQ(options.recipes.size(), 2u);
  EXPECT_EQ(options.recipes[0].preset, "reference");
  EXPECT_EQ(options.recipes[1].preset, "lightcluster");
  for (const NamedRecipe& side : options.recipes) EXPECT_EQ(side.recipe.face_size_px, 256u);
  EXPECT_NE(options.recipes[0].recipe.select, options.recipes[1].recipe.select);
}

TEST(PlayerOptions, FiltersBesideTruthAreTheOtherSides) {
  const Options options =
      accepted("scene.chandelier --compare truth,reference --report r --filter pcf --deliver inline --shade lambert");
  EXPECT_EQ(stage_answer(options.recipes[0].recipe, "filter"), "rays");
  EXPECT_EQ(stage_answer(options.recipes[0].recipe, "deliver"), "textures");
  EXPECT_EQ(stage_answer(options.recipes[1].recipe, "filter"), "pcf");
  EXPECT_EQ(stage_answer(options.recipes[1].recipe, "deliver"), "inline");
  for (const NamedRecipe& side : options.recipes) EXPECT_EQ(stage_answer(side.recipe, "shade"), "lambert");
  EXPECT_EQ(stage_answer(accepted("s --preset truth --output a.png").recipes[0].recipe, "filter"), "rays");
  EXPECT_TRUE(traces_rays(options.recipes[0]));
  EXPECT_FALSE(traces_rays(options.recipes[1]));
}

TEST(PlayerOptions, CameraNumbers) {
  const FileCamera typed = accepted("scene.chandelier --output a.png --camera 1,2,3,1,2,-7,90").camera.value();
  EXPECT_EQ(typed.eye_m, glm::dvec3(1, 2, 3));
  const Camera camera = in_world(typed, {1, 0, -1});
  EXPECT_EQ(camera.eye_ws, glm::vec3(0, 2, 4));
  EXPECT_EQ(camera.forward_ws, glm::vec3(0, 0, -1));
  EXPECT_NEAR(camera.yfov_rad, 1.5707963f, 1e-6f);
  EXPECT_EQ(accepted("scene.chandelier --output a.png --camera balcony,left").camera_name, "balcony,left");
}

TEST(PlayerOptions, HelpNamesStagesAnswersAndPresets) {
  const Parsed help = parse("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const StageChoices& choices : stage_choices()) {
    EXPECT_NE(help.text.find("--" + std::string(choices.stage)), std::string::npos) << choices.stage;
    for (const auto& [chosen, meaning] : choices.answers) {
      EXPECT_NE(help.text.find(chosen), std::string::npos) << chosen;
      EXPECT_NE(help.text.find(meaning), std::string::npos) << meaning;
    }
  }
  for (const Preset& preset : presets()) EXPECT_NE(help.text.find(preset.description), std::string::npos);
  EXPECT_EQ(parse("--version").exit_code, 0);
}

TEST(PlayerOptions, RefusesWrongUsage) {
  expect_refused("", "PACK is missing");
  expect_refused("--output a.png", "PACK is missing");
  expect_refused("s --bogus", "--bogus");
  expect_refused("s t --output a.png", "t");
  expect_refused("s --output a.jpg", "must end in .png");
  expect_refused("s --output png", "must end in .png");
  expect_refused("s --stats s.json", "needs --output");
  expect_refused("s --report r", "needs --compare");
}

TEST(PlayerOptions, RefusesWrongValues) {
  const std::string s = "s --output a.png ";
  for (const char* size : {"0x4", "4x0", "4", "4x", "x4", "-4x4", "4x4x4", "4.5x4", "16385x4", "99999999999x4"})
    expect_refused(s + "--size " + size, "--size: must be");
  for (const char* camera : {"1,2,3", "1,2,3,4,5,6,0", "1,2,3,4,5,6,179", "1,2,3,1,2,3,60", "1,2,3,4,5,6,60,7",
                             "1,,3,4,5,6,60", "1,2,3,4,5,6,1e39"})
    expect_refused(s + "--camera " + camera, "--camera: must be");
  for (const char* exposure : {"nan", "bright", "101", "inf"})
    expect_refused(s + "--exposure " + exposure, "--exposure: must be");
  for (const char* frames : {"0", "-1", "1.5", "many"}) expect_refused(s + "--frames " + frames, "--frames");
  for (const char* length : {"nan", "-0.1", "inf", "x"}) {
    expect_refused(s + "--d-init " + length, "--d-init");
    expect_refused(s + "--z-far " + length, "--z-far");
    expect_refused(s + "--ambient " + length, "--ambient");
  }
  expect_refused(s + "--z-far 0", "--z-far");
  expect_refused(s + "--face-size 0", "--face-size");
  expect_refused(s + "--shadow-budget 0", "--shadow-budget");
  expect_refused(s + "--distance-scaling shrink", "must be one of grow, paper-formula, none (shrink)");
  expect_refused(s + "--preset fancy", "must be one of reference");
  for (const StageChoices& choices : stage_choices())
    expect_refused(s + "--" + std::string(choices.stage) + " nothing", "must be one of");
}

TEST(PlayerOptions, RefusesWrongComparisons) {
  const std::string s = "s --compare reference,lightcluster ";
  expect_refused(s, "needs --report");
  expect_refused("s --compare reference --report r", "must be two presets");
  expect_refused("s --compare reference,fancy --report r", "(fancy)");
  expect_refused("s --compare reference,lightcluster,reference --report r", "(lightcluster,reference)");
  expect_refused(s + "--report r --output a.png", "--output");
  expect_refused(s + "--report r --stats s.json", "--stats");
  expect_refused(s + "--report r --preset reference", "--preset");
  expect_refused(s + "--report r --select per-light", "--select");
}

TEST(PlayerOptions, RefusesRecipesThatCannotBeRendered) {
  // The reasons are refusal()'s, word for word.
  Recipe recipe = presets().front().recipe;
  recipe.select = Select::light_clusters;
  recipe.filter = Filter::hard;
  ASSERT_TRUE(refusal(recipe));
  expect_refused("s --output a.png --select light-clusters --filter hard", *refusal(recipe));
  expect_refused("s --compare reference,lightcluster --report r --filter hard",
                 "preset lightcluster: " + *refusal(recipe));
  accepted("s --compare reference,lightcluster --report r --filter hard --d-init 0");
  recipe = presets().front().recipe;
  recipe.face_size_px = 8;
  EXPECT_EQ(refusal(recipe), "face-size must be from 16 to 16384 texels (8)");
  expect_refused("s --output a.png --face-size 8", "--face-size: must be from 16 to 16384 texels (8)");
  expect_refused("s --output a.png --face-size 64.5",
                 "--face-size: must be a whole number from 16 to 16384 texels (64.5)");
}

TEST(PlayerOptions, PredictDrawsNothing) {
  const Options options = accepted("scene.chandelier --predict --stats p.json --preset lightcluster --size 64x32");
  EXPECT_EQ(options.mode, Mode::predict);
  EXPECT_EQ(options.stats, "p.json");
  EXPECT_FALSE(options.budget.is_given());
  expect_refused("scene.chandelier --predict --output a.png", "--predict: cannot be used with --output");
  expect_refused("scene.chandelier --predict --frames 3", "--predict: cannot be used with --frames");
  expect_refused("scene.chandelier --predict --compare reference,lightcluster --report r", "--compare: cannot be used");
}

TEST(PlayerOptions, BudgetsChooseDInit) {
  const Options options =
      accepted("scene.chandelier --output a.png --preset lightcluster --max-shadow-maps 24 --max-shadow-bytes 100");
  EXPECT_EQ(options.budget.max_shadow_maps, 24u);
  EXPECT_EQ(options.budget.max_shadow_bytes, uint64_t{100} << 20);
  accepted("scene.chandelier --compare reference,lightcluster --report r --max-shadow-maps 24");
  expect_refused("scene.chandelier --output a.png --max-shadow-maps 24", "--max-shadow-maps: needs light clusters");
  EXPECT_EQ(accepted("scene.chandelier --preset lightcluster --max-error 0.03").budget.max_error, 0.03f);
  expect_refused("scene.chandelier --preset lightcluster --max-error 1.5", "--max-error: must be a number from 0 to 1");
  expect_refused("scene.chandelier --max-error 0.1", "--max-error: needs light clusters");
  EXPECT_FALSE(options.budget.d_init_is_least);
  const Options least = accepted("scene.chandelier --preset lightcluster --d-init 1 --max-shadow-bytes 24");
  EXPECT_TRUE(least.budget.d_init_is_least);
  EXPECT_EQ(least.recipes.at(0).recipe.d_init_m, 1.0f);
  expect_refused("scene.chandelier --preset lightcluster --d-init 1 --max-shadow-bytes 24 --max-error 0.1",
                 "--max-error: cannot be used with --d-init");
  expect_refused("scene.chandelier --preset chandelier --d-init 1 --max-shadow-maps 9",
                 "--max-shadow-maps: cannot be used with --d-init where lights are selected by error");
  expect_refused("scene.chandelier --output a.png --preset lightcluster --max-shadow-maps 0", "--max-shadow-maps");
}

TEST(PlayerOptions, Walls) {
  EXPECT_EQ(accepted("scene.chandelier").recipes.at(0).recipe.walls, WallTest::none);
  EXPECT_EQ(accepted("scene.chandelier --preset lightcluster --walls rays").recipes.at(0).recipe.walls, WallTest::rays);
  expect_refused("scene.chandelier --walls brick", "--walls: must be one of none, voxels, rays (brick)");
}

}  // namespace
}  // namespace chandelier::player
