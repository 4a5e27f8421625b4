// SPDX-License-Identifier: Apache-2.0
// Options of chandelier-play. Those of a recipe come from the table in schemas/frame.xml: a new one needs no change
// here.
#include "player/typed_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <span>

#include "frame/recipe.h"
#include "player/image_files.h"
#ifndef CHANDELIER_PORTABLE
#include "player/window_keys.h"
#endif

namespace chandelier::player {
namespace {

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

CLI::Validator one_of(std::vector<std::string> names) {
  return CLI::Validator(
      [names](const std::string& text) {
        if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
        return fmt::format("must be one of {} ({})", fmt::join(names, ", "), text);
      },
      "");
}

std::vector<std::string> names_of(std::span<const Answer> answers) {
  std::vector<std::string> names;
  for (const Answer& each : answers) names.emplace_back(each.name);
  return names;
}

// The answers of each stage, and of settings whose values have names, with their meanings.
std::string answers_text() {
  std::string text;
  const auto add = [&](std::string_view option, std::string_view question, std::span<const Answer> answers) {
    text += fmt::format("\n--{}: {}\n", option, question);
    for (const Answer& each : answers) text += fmt::format("  {:<22}{}\n", each.name, each.meaning);
  };
  for (const StageChoices& stage : stage_choices()) add(stage.stage, stage.question, stage.answers);
  for (const Setting& setting : recipe_settings())
    if (!setting.answers.empty()) add(setting.option, setting.meaning, setting.answers);
  return text;
}

std::string footer() {
  std::string text = "Presets:\n";
  for (const Preset& preset : presets()) text += fmt::format("  {:<22}{}\n", preset.name, preset.description);
  text += answers_text();
#ifndef CHANDELIER_PORTABLE
  text += "\nIn the window:\n";
  for (const WindowKey& key : window_keys) text += fmt::format("  {:<22}{}\n", key.name, key.meaning);
#endif
  text +=
      "\nA window shows the new pack when the file is replaced, and keeps the camera where it is. If the new pack "
      "cannot\n"
      "be shown, an error says why and the old one stays.\n"
      "\nExamples:\n"
      "  chandelier-play scene.chandelier                       fly through it in a window\n"
      "  chandelier-play scene.chandelier --output frame.png    one picture, no display needed\n"
      "  chandelier-play scene.chandelier --output frame.png --preset lightcluster --d-init 0.3 --frames 9 "
      "--stats frame.json\n"
      "  chandelier-play scene.chandelier --compare reference,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --compare truth,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --path walk.json --preset lightcluster --report report\n"
      "  chandelier-play scene.chandelier --predict --preset lightcluster --max-shadow-maps 24\n"
      "\nExit status: 0 done, 1 failed (or the validation layer reported something), 2 wrong usage.";
  return text;
}

void declare_output(CLI::App& app, Typed& typed) {
  app.add_option("PACK", typed.pack, "The pack to draw, made by chandelier-bake");
  app.add_option("--output", typed.output,
                 fmt::format("Draw into this file, without a display: {}", image_kinds_text()))
      ->type_name("FILE")
      ->group("Output");
  app.add_option("--size", typed.size, "Width and height of the picture, pixels")
      ->type_name("WxH")
      ->capture_default_str()
      ->group("Output");
  app.add_option("--frames", typed.frames,
                 "Timed frames to draw [1; with --compare 5, or 1 if a side is truth]. A window closes after that many")
      ->type_name("N")
      ->check(number_between(1, 1000000))
      ->group("Output");
  app.add_option("--stats", typed.stats, "Write times and counters as JSON")->type_name("FILE.json")->group("Output");
  app.add_option("--compare", typed.compare, "Draw with two presets and report their difference")
      ->type_name("A,B")
      ->group("Output");
  app.add_flag("--keep-shadow-maps", typed.keep_shadow_maps,
               "With --frames and --path, do not draw a shadow map again that an earlier frame drew and that has not "
               "changed. Triangles and draws are then those of the others. Windows always do so")
      ->group("Output");
  app.add_flag("--predict", typed.predict, "Print what a frame will cost, without drawing it or opening a device")
      ->group("Output");
  app.add_option("--path", typed.path,
                 "Move the camera along this path and report what changes from frame to frame [60 frames]")
      ->type_name("FILE.json")
      ->group("Output");
  app.add_option("--report", typed.report, "Folder for what --compare or --path writes; made if it is missing")
      ->type_name("DIR")
      ->group("Output");
}

void declare_view(CLI::App& app, Typed& typed) {
  app.add_option(
         "--camera", typed.camera,
         "A camera of the pack by name, or eye, target (glTF's coordinates, metres) and vertical angle in degrees [the "
         "pack's first camera; without one, a view of something lit]")
      ->type_name("NAME|ex,ey,ez,tx,ty,tz,fov_deg")
      ->group("View");
  app.add_option(
         "--ambient", typed.ambient,
         "Radiance from every direction, or from straight above and straight below, and between them in between. "
         "It casts no shadow")
      ->type_name("R|UP,DOWN")
      ->capture_default_str()
      ->group("View");
  app.add_option("--headlight", typed.headlight,
                 "A light in the camera, equally bright at any distance: auto, on, off, or the radiance of a white "
                 "surface that "
                 "faces it. auto: on if the pack has no lights and there is no --ambient")
      ->type_name("auto|on|off|R")
      ->capture_default_str()
      ->group("View");
  app.add_option(
         "--anisotropy", typed.anisotropy,
         "Sharpness of textures on slanted surfaces: 1 to 16 samples along the slant. auto: 8 on a GPU, 1 where "
         "the CPU draws")
      ->type_name("N|auto")
      ->capture_default_str()
      ->group("View");
  app.add_option("--samples", typed.samples,
                 "Samples in a pixel, which smooth edges: 1, 2, 4 or 8. auto: 4 on a GPU that can, 1 where "
                 "the CPU draws")
      ->type_name("N|auto")
      ->check(one_of({"auto", "1", "2", "4", "8"}))
      ->capture_default_str()
      ->group("View");
  app.add_option("--exposure", typed.exposure, "Stops; auto computes it from the picture's brightness")
      ->type_name("EV|auto")
      ->capture_default_str()
      ->group("View");
}

void declare_device(CLI::App& app, Typed& typed) {
  app.add_option("--device", typed.device, "Part of a Vulkan device's name, or its number [a GPU, else a CPU]")
      ->type_name("NAME")
      ->group("Device");
  app.add_flag("--list-devices", typed.list_devices, "List the Vulkan devices and exit")->group("Device");
  app.add_flag("--validation", typed.validation, "Use the validation layer; exit status 1 if it reports anything")
      ->group("Device");
}

CLI::Validator allowed_value(const Setting& setting) {
  if (!setting.answers.empty()) return one_of(names_of(setting.answers));
  return CLI::Validator(
      [&setting](const std::string& text) {
        double value = 0.0;
        const bool is_number = CLI::detail::lexical_cast(text, value);
        // "nan" compares false with everything, so ask for what is right, not for what is wrong.
        if (is_number && value >= setting.typed_least && value <= setting.typed_most) return std::string();
        return fmt::format("must be {} ({})", setting.range_text, text);
      },
      "");
}

void declare_settings(CLI::App& app, Typed& typed) {
  const auto settings = recipe_settings();
  typed.settings.resize(settings.size());
  for (size_t i = 0; i < settings.size(); ++i) {
    const Setting& setting = settings[i];
    if (setting.option.empty()) continue;
    std::string help(setting.meaning);
    if (!setting.answers.empty()) help += fmt::format(": {}", fmt::join(names_of(setting.answers), ", "));
    app.add_option(
           fmt::format("--{}", setting.option), typed.settings[i],
           fmt::format("{} [{}{}{}]", help, setting.default_text, setting.unit.empty() ? "" : " ", setting.unit))
        ->type_name(std::string(setting.placeholder))
        ->check(allowed_value(setting))
        ->group("Settings (each overrides the preset)");
  }
}

void declare_recipe(CLI::App& app, Typed& typed) {
  app.add_option("--preset", typed.preset,
                 fmt::format("{}, see below [{}]", fmt::join(preset_names(), ", "), presets().front().name))
      ->type_name("NAME")
      ->check(one_of(preset_names()))
      ->group("Recipe");
  const auto stages = stage_choices();
  typed.answers.resize(stages.size());
  for (size_t i = 0; i < stages.size(); ++i) {
    const auto answers = names_of(stages[i].answers);
    app.add_option(fmt::format("--{}", stages[i].stage), typed.answers[i],
                   fmt::format("{} {} [the preset's]", stages[i].question, fmt::join(answers, ", ")))
        ->type_name("ANSWER")
        ->check(one_of(answers))
        ->group("Recipe (each overrides the preset)");
  }
}

void declare_budget(CLI::App& app, Typed& typed) {
  const std::string group =
      "Budget (light clusters: chooses d-init, not below a given --d-init. --select error-driven: limits the "
      "selection. "
      "Maps and bytes come before the error)";
  app.add_option("--max-shadow-maps", typed.max_shadow_maps, "Largest number of shadow maps in a frame")
      ->type_name("N")
      ->check(number_between(1, 1e9))
      ->group(group);
  app.add_option("--max-shadow-bytes", typed.max_shadow_bytes,
                 "Largest size of all shadow maps of a frame together, MiB")
      ->type_name("MIB")
      ->check(number_between(1, 1 << 20))
      ->group(group);
  app.add_option("--max-error", typed.max_error,
                 "Largest expected error of the shown picture, RMSE against one shadow map per light; takes the fewest "
                 "maps that "
                 "meet it")
      ->type_name("RMSE")
      ->check(number_between(0, 1))
      ->group(group);
}

}  // namespace

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return names;
}

void declare_options(CLI::App& app, Typed& typed) {
  app.footer(footer);
  declare_output(app, typed);
  declare_view(app, typed);
  declare_device(app, typed);
  declare_recipe(app, typed);
  declare_settings(app, typed);
  declare_budget(app, typed);
}

}  // namespace chandelier::player
