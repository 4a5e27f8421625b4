// SPDX-License-Identifier: Apache-2.0
// Options of chandelier-play. Stages and their answers come from stage_choices(), so a new answer needs no change here.
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

std::vector<std::string> strings(std::span<const std::string_view> views) {
  return {views.begin(), views.end()};
}

std::string footer() {
  std::string text = "Presets:\n";
  for (const Preset& preset : presets()) text += fmt::format("  {:<18}{}\n", preset.name, preset.description);
#ifndef CHANDELIER_PORTABLE
  text += "\nIn the window:\n";
  for (const WindowKey& key : window_keys) text += fmt::format("  {:<22}{}\n", key.name, key.meaning);
#endif
  text +=
      "\nA window shows whatever pack takes its file's place, from where one has flown to. What cannot be shown is\n"
      "told, and the older one stays.\n"
      "\nExamples:\n"
      "  chandelier-play scene.chandelier                       fly through it in a window\n"
      "  chandelier-play scene.chandelier --output frame.png    one picture, no display needed\n"
      "  chandelier-play scene.chandelier --output frame.png --preset lightcluster --d-init 0.3 --frames 9 "
      "--stats frame.json\n"
      "  chandelier-play scene.chandelier --compare reference,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --compare truth,lightcluster --report report\n"
      "  chandelier-play scene.chandelier --path walk.json --preset lightcluster --report report\n"
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
         "A camera of the pack, or eye and target in the glTF's coordinates, vertical angle [the pack's first, else "
         "one that sees something lit]")
      ->type_name("NAME|ex,ey,ez,tx,ty,tz,fov_deg")
      ->group("View");
  app.add_option("--ambient", typed.ambient, "Radiance from everywhere")
      ->type_name("R")
      ->check(number_between(0.0, 1e6))
      ->capture_default_str()
      ->group("View");
  app.add_option(
         "--headlight", typed.headlight,
         "A light in the camera, as bright at any distance: auto, on, off, or the radiance that it gives a white "
         "surface. auto: on where the pack has no lights and there is no --ambient")
      ->type_name("auto|on|off|R")
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
  app.add_option(
         "--stability", typed.stability,
         fmt::format("Light clusters: how much lights cling to what they were a frame ago [{}]", defaults.stability))
      ->type_name("S")
      ->check(number_between(0.0, 0.999))
      ->group(group);
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
  const std::string group =
      "Budget (chooses d-init: --d-init where that keeps maps and bytes. Or is kept by --select error-driven. Maps and "
      "bytes come before the error)";
  app.add_option("--max-shadow-maps", typed.max_shadow_maps, "Most shadow maps of a frame")
      ->type_name("N")
      ->check(number_between(1, 1e9))
      ->group(group);
  app.add_option("--max-shadow-bytes", typed.max_shadow_bytes, "Most depth of all shadow maps of a frame, MiB")
      ->type_name("MIB")
      ->check(number_between(1, 1 << 20))
      ->group(group);
  app.add_option(
         "--max-error", typed.max_error,
         "Most error expected of the shown picture, RMSE against a shadow map for each light; as few maps as do")
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
  declare_budget(app, typed);
}

}  // namespace chandelier::player
