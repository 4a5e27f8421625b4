// SPDX-License-Identifier: Apache-2.0
// The command line of chandelier-play. Stages and their answers come from stage_choices(), so a new answer needs no
// change here.
#include "player/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "player/camera.h"
#include "player/image_files.h"

namespace chandelier::player {
namespace {

constexpr uint32_t kLargestPicture = 16384;  // texels a side; no Vulkan device draws more

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The arguments as typed, before they are checked against each other.
struct Typed {
  std::string pack, output, size = "1280x720", camera, stats, device, preset, exposure = "auto", compare, report;
  std::optional<uint32_t> frames;
  bool list_devices = false;
  bool predict = false;
  bool validation = false;
  std::vector<std::string> answers;  // one per stage; empty where not given
  std::optional<float> d_init, z_far, reference_share;
  std::string distance_scaling, dynamic_lights, area_radius, walls;
  std::optional<uint32_t> face_size, shadow_budget, max_shadow_maps, max_shadow_bytes;
  float ambient = 0.0f;
};

CLI::Validator number_between(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        // "nan" compares false with everything, so ask for what is right, not for what is wrong.
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("must be a number from {} to {} ({})", low, high, text);
      },
      "");
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return names;
}

CLI::Validator one_of(std::vector<std::string> names) {
  return CLI::Validator(
      [names](const std::string& text) {
        if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
        return fmt::format("must be one of {} ({})", fmt::join(names, ", "), text);
      },
      "");
}

std::vector<std::string> strings(std::span<const std::string_view> views) {
  return {views.begin(), views.end()};
}

std::string footer() {
  std::string text = "Presets:\n";
  for (const Preset& preset : presets()) text += fmt::format("  {:<14}{}\n", preset.name, preset.description);
  text +=
      "\nExamples:\n"
      "  chandelier-play scene.chandelier                       fly through it in a window\n"
      "  chandelier-play scene.chandelier --output frame.png    one picture, no display needed\n"
      "  chandelier-play scene.chandelier --output frame.png --preset lightcluster --d-init 0.3 --frames 9 "
      "--stats frame.json\n"
      "  chandelier-play scene.chandelier --compare reference,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --compare truth,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --predict --preset lightcluster --max-shadow-maps 24\n"
      "\nExit status: 0 done, 1 failed (or the validation layer spoke), 2 wrong usage.";
  return text;
}

void declare_output(CLI::App& app, Typed& typed) {
  app.add_option("PACK", typed.pack, "The pack to draw, made by chandelier-bake");
  app.add_option("--output", typed.output, fmt::format("Draw without a display into this file: {}", image_kinds_text()))
      ->type_name("FILE")
      ->group("Output");
  app.add_option("--size", typed.size, "Width and height of the picture, pixels")
      ->type_name("WxH")
      ->capture_default_str()
      ->group("Output");
  app.add_option("--frames", typed.frames,
                 "Timed frames to draw [1, with --compare 5, beside truth 1; a window closes after so many]")
      ->type_name("N")
      ->check(number_between(1, 1000000))
      ->group("Output");
  app.add_option("--stats", typed.stats, "Write times and counters as JSON")->type_name("FILE.json")->group("Output");
  app.add_option("--compare", typed.compare, "Draw with two presets and report their difference")
      ->type_name("A,B")
      ->group("Output");
  app.add_flag("--predict", typed.predict, "Say what a frame will take, without drawing it or opening a device")
      ->group("Output");
  app.add_option("--report", typed.report, "Folder for what --compare writes; made if it is missing")
      ->type_name("DIR")
      ->group("Output");
}

void declare_view(CLI::App& app, Typed& typed) {
  app.add_option("--camera", typed.camera,
                 "A camera of the pack, or eye, target, vertical angle [the pack's first, else sees it all]")
      ->type_name("NAME|ex,ey,ez,tx,ty,tz,fov_deg")
      ->group("View");
  app.add_option("--ambient", typed.ambient, "Radiance from everywhere")
      ->type_name("R")
      ->check(number_between(0.0, 1e6))
      ->capture_default_str()
      ->group("View");
  app.add_option("--exposure", typed.exposure, "Stops, or auto: from the picture's own brightness")
      ->type_name("EV|auto")
      ->capture_default_str()
      ->group("View");
}

void declare_device(CLI::App& app, Typed& typed) {
  app.add_option("--device", typed.device, "Part of a Vulkan device's name, or its number [a GPU, else a CPU]")
      ->type_name("NAME")
      ->group("Device");
  app.add_flag("--list-devices", typed.list_devices, "List the Vulkan devices and leave")->group("Device");
  app.add_flag("--validation", typed.validation, "Use the validation layer; exit 1 if it has anything to say")
      ->group("Device");
}

constexpr std::string_view settings_group = "Settings (each overrides the preset)";

void declare_named(CLI::App& app, const std::string& option, std::string_view meaning,
                   std::span<const std::string_view> names, std::size_t default_name, std::string& typed) {
  app.add_option(option, typed, fmt::format("{}: {} [{}]", meaning, fmt::join(names, ", "), names[default_name]))
      ->type_name("NAME")
      ->check(one_of(strings(names)))
      ->group(std::string(settings_group));
}

// Leaves the value as it is where nothing was typed.
template <typename Enum>
void read_named(const std::string& typed, std::span<const std::string_view> names, Enum& value) {
  const auto name = std::find(names.begin(), names.end(), typed);
  if (name != names.end()) value = static_cast<Enum>(name - names.begin());
}

void declare_recipe(CLI::App& app, Typed& typed) {
  const Recipe defaults;
  app.add_option("--preset", typed.preset,
                 fmt::format("{}, see below [{}]", fmt::join(preset_names(), ", "), presets().front().name))
      ->type_name("NAME")
      ->check(one_of(preset_names()))
      ->group("Recipe");
  const auto stages = stage_choices();
  typed.answers.resize(stages.size());
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const auto answers = strings(stages[i].answers);
    app.add_option(fmt::format("--{}", stages[i].stage), typed.answers[i],
                   fmt::format("{} {} [the preset's]", stages[i].question, fmt::join(answers, ", ")))
        ->type_name("ANSWER")
        ->check(one_of(answers))
        ->group("Recipe (each overrides the preset)");
  }
  const std::string group(settings_group);
  app.add_option("--d-init", typed.d_init,
                 fmt::format("Light clusters: d_min at the camera, metres [{}]", defaults.d_init_m))
      ->type_name("M")
      ->check(number_between(0.0, 1e6))
      ->group(group);
  app.add_option("--z-far", typed.z_far,
                 fmt::format("Light clusters: distance that scales d_min, metres [{}]", defaults.z_far_m))
      ->type_name("M")
      ->check(number_between(1e-3, 1e6))
      ->group(group);
  declare_named(app, "--distance-scaling", "Light clusters: how d_min follows distance", distance_scaling_names(),
                static_cast<std::size_t>(defaults.distance_scaling), typed.distance_scaling);
  declare_named(app, "--dynamic-lights", "Light clusters: whether lights that move share maps or have their own",
                dynamic_lights_names(), static_cast<std::size_t>(defaults.dynamic_lights), typed.dynamic_lights);
  declare_named(app, "--area-radius", "Light clusters: radius of the area light that stands for one",
                area_radius_names(), static_cast<std::size_t>(defaults.area_radius), typed.area_radius);
  declare_named(app, "--walls", "Light clusters: what keeps them from reaching through walls", wall_test_names(),
                static_cast<std::size_t>(defaults.walls), typed.walls);
  app.add_option("--reference-share", typed.reference_share,
                 fmt::format("From so many light clusters per light on, the reference is drawn: one hard map each. "
                             "Above 1: never [{}]",
                             defaults.reference_share))
      ->type_name("R")
      ->check(number_between(1e-3, 1e6))
      ->group(group);
  app.add_option("--face-size", typed.face_size,
                 fmt::format("Width of one face of a cube shadow map, texels [{}]", defaults.face_size_px))
      ->type_name("N")
      ->check(number_between(1, kLargestPicture))
      ->group(group);
  app.add_option("--shadow-budget", typed.shadow_budget,
                 fmt::format("Shadow-map depth held at a time, MiB [{}]", defaults.shadow_budget_bytes >> 20))
      ->type_name("MIB")
      ->check(number_between(1, 1 << 20))
      ->group(group);
}

void declare_budget(CLI::App& app, Typed& typed) {
  const std::string group = "Budget (chooses d-init: as many shadow maps as it allows)";
  app.add_option("--max-shadow-maps", typed.max_shadow_maps, "Most shadow maps of a frame")
      ->type_name("N")
      ->check(number_between(1, 1e9))
      ->group(group);
  app.add_option("--max-shadow-bytes", typed.max_shadow_bytes, "Most depth of all shadow maps of a frame, MiB")
      ->type_name("MIB")
      ->check(number_between(1, 1 << 20))
      ->group(group);
}

template <typename T>
bool whole_number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

void read_size(const std::string& text, Options& options) {
  const auto x = text.find('x');
  const std::string_view view = text;
  if (x == std::string::npos || !whole_number(view.substr(0, x), options.width) ||
      !whole_number(view.substr(x + 1), options.height) || options.width < 1 || options.height < 1 ||
      options.width > kLargestPicture || options.height > kLargestPicture)
    throw UsageError(fmt::format("--size: must be WIDTHxHEIGHT, each from 1 to {} ({})", kLargestPicture, text));
}

void read_exposure(const std::string& text, Options& options) {
  if (text == "auto") return;
  float ev = 0.0f;
  if (!CLI::detail::lexical_cast(text, ev) || !(std::abs(ev) <= 100.0f))
    throw UsageError(fmt::format("--exposure: must be auto or a number of stops from -100 to 100 ({})", text));
  options.exposure_ev = ev;
}

void read_camera(const std::string& text, Options& options) {
  if (!is_camera_numbers(text)) {
    options.camera_name = text;
    return;
  }
  options.camera = camera_from_numbers(text);
  if (!options.camera)
    throw UsageError(fmt::format(
        "--camera: must be a name, or ex,ey,ez,tx,ty,tz,fov_deg with eye and target apart and 0 < fov_deg < 179 ({})",
        text));
}

NamedRecipe make_recipe(const std::string& preset_name, const Typed& typed) {
  const auto all = presets();
  const auto preset = std::find_if(all.begin(), all.end(), [&](const Preset& p) { return p.name == preset_name; });
  if (preset == all.end())
    throw UsageError(
        fmt::format("no such preset: must be one of {} ({})", fmt::join(preset_names(), ", "), preset_name));
  Recipe recipe = preset->recipe;
  for (std::size_t i = 0; i < typed.answers.size(); ++i)
    if (!typed.answers[i].empty()) set_answer(recipe, i, typed.answers[i]);
  if (typed.d_init) recipe.d_init_m = *typed.d_init;
  if (typed.z_far) recipe.z_far_m = *typed.z_far;
  if (typed.reference_share) recipe.reference_share = *typed.reference_share;
  if (typed.face_size) recipe.face_size_px = *typed.face_size;
  if (typed.shadow_budget) recipe.shadow_budget_bytes = uint64_t{*typed.shadow_budget} << 20;
  read_named(typed.distance_scaling, distance_scaling_names(), recipe.distance_scaling);
  read_named(typed.dynamic_lights, dynamic_lights_names(), recipe.dynamic_lights);
  read_named(typed.area_radius, area_radius_names(), recipe.area_radius);
  read_named(typed.walls, wall_test_names(), recipe.walls);
  if (const auto reason = refusal(recipe)) throw UsageError(fmt::format("preset {}: {}", preset_name, *reason));
#ifndef CHANDELIER_EMBREE
  if (recipe.filter == Filter::rays)
    throw UsageError(fmt::format("preset {}: this build has no rays, which need Embree", preset_name));
#endif
  return {preset_name, recipe};
}

// A side of a comparison. Truth stays truth: how shadow maps are to be read is said to the other side.
NamedRecipe make_side(const std::string& preset_name, Typed typed) {
  const NamedRecipe preset = make_recipe(preset_name, Typed{.answers = std::vector<std::string>(typed.answers.size())});
  for (std::size_t i = 0; i < typed.answers.size(); ++i)
    if (traces_rays(preset) && (stage_choices()[i].stage == "filter" || stage_choices()[i].stage == "deliver"))
      typed.answers[i].clear();
  return make_recipe(preset_name, typed);
}

void read_budget(const Typed& typed, Options& options) {
  if (typed.max_shadow_maps) options.budget.max_shadow_maps = *typed.max_shadow_maps;
  if (typed.max_shadow_bytes) options.budget.max_shadow_bytes = uint64_t{*typed.max_shadow_bytes} << 20;
  if (!options.budget.is_given()) return;
  const std::string_view option = typed.max_shadow_maps ? "--max-shadow-maps" : "--max-shadow-bytes";
  if (typed.d_init) throw UsageError(fmt::format("{}: cannot be used with --d-init, which it chooses", option));
  if (std::none_of(options.recipes.begin(), options.recipes.end(),
                   [](const NamedRecipe& each) { return each.recipe.select != Select::per_light; }))
    throw UsageError(fmt::format("{}: needs light clusters, such as --preset lightcluster", option));
}

void read_comparison(const Typed& typed, Options& options) {
  const auto comma = typed.compare.find(',');
  if (comma == std::string::npos)
    throw UsageError(fmt::format("--compare: must be two presets, A,B ({})", typed.compare));
  if (typed.report.empty()) throw UsageError("--compare: needs --report DIR for what it writes");
  if (!typed.output.empty())
    throw UsageError("--compare: cannot be used with --output; --report DIR gets the pictures");
  if (!typed.stats.empty())
    throw UsageError("--compare: cannot be used with --stats; --report DIR gets comparison.json");
  if (!typed.preset.empty()) throw UsageError("--compare: cannot be used with --preset; A and B are presets");
  if (typed.predict) throw UsageError("--compare: cannot be used with --predict");
  for (std::size_t i = 0; i < typed.answers.size(); ++i)
    if (stage_choices()[i].stage == "select" && !typed.answers[i].empty())
      throw UsageError("--compare: cannot be used with --select, which would make both sides select alike");
  options.mode = Mode::compare;
  options.report = typed.report;
  options.recipes = {make_side(typed.compare.substr(0, comma), typed),
                     make_side(typed.compare.substr(comma + 1), typed)};
}

void read_single(const Typed& typed, Options& options) {
  if (!typed.report.empty()) throw UsageError("--report: needs --compare A,B");
  if (typed.predict) {
    if (!typed.output.empty()) throw UsageError("--predict: cannot be used with --output; it draws nothing");
    if (typed.frames) throw UsageError("--predict: cannot be used with --frames; it draws none");
    options.mode = Mode::predict;
    options.stats = typed.stats;
  } else if (!typed.output.empty()) {
    if (!image_kind(typed.output))
      throw UsageError(fmt::format("--output: must end in {} ({})", image_kinds_text(), typed.output));
    options.mode = Mode::headless;
    options.output = typed.output;
    options.stats = typed.stats;
  } else {
    if (!typed.stats.empty()) throw UsageError("--stats: needs --output FILE or --predict");
#ifdef CHANDELIER_PORTABLE
    throw UsageError("this portable build opens no window: use --output FILE.png or --compare A,B");
#endif
    options.mode = Mode::window;
  }
  options.recipes = {make_recipe(typed.preset.empty() ? std::string(presets().front().name) : typed.preset, typed)};
}

Options checked(const Typed& typed) {
  Options options;
  options.device = typed.device;
  options.validation = typed.validation;
  if (typed.list_devices) {
    options.mode = Mode::list_devices;
    return options;
  }
  if (typed.pack.empty()) throw UsageError("PACK is missing");
  options.pack = typed.pack;
  options.frames = typed.frames;
  options.ambient = typed.ambient;
  read_size(typed.size, options);
  read_exposure(typed.exposure, options);
  read_camera(typed.camera, options);
  if (typed.compare.empty())
    read_single(typed, options);
  else
    read_comparison(typed, options);
  read_budget(typed, options);
  return options;
}

Parsed usage_error(std::string what) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  return {std::nullopt, 2, fmt::format("chandelier-play: error: {}; --help tells more", what)};
}

}  // namespace

Parsed parse_options(const std::vector<std::string>& arguments) {
  CLI::App app("Draws a Chandelier pack: in a window, into a picture, or with two presets side by side.",
               "chandelier-play");
  app.set_version_flag("--version", "chandelier-play " CHANDELIER_VERSION);
  app.get_formatter()->column_width(44);
  app.footer(footer);
  Typed typed;
  declare_output(app, typed);
  declare_view(app, typed);
  declare_device(app, typed);
  declare_recipe(app, typed);
  declare_budget(app, typed);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 takes them last first
    return {checked(typed), 0, {}};
  } catch (const CLI::CallForHelp&) {
    return {std::nullopt, 0, app.help()};
  } catch (const CLI::CallForVersion& version) {
    return {std::nullopt, 0, fmt::format("{}\n", version.what())};
  } catch (const CLI::ParseError& error) {
    return usage_error(error.what());
  } catch (const UsageError& error) {
    return usage_error(error.what());
  }
}

RenderSettings render_settings(const Options& options, const Recipe& recipe, const Camera& camera,
                               const VisibilitySource& visibility) {
  RenderSettings settings;
  settings.recipe = recipe;
  settings.camera = camera;
  settings.width = options.width;
  settings.height = options.height;
  settings.ambient = options.ambient;
  settings.exposure_ev = options.exposure_ev;
  settings.visibility = visibility;
  return settings;
}

}  // namespace chandelier::player
