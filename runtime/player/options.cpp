// SPDX-License-Identifier: Apache-2.0
// Turns the parsed command line of chandelier-play into options, checked against each other.
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
#include "player/typed_options.h"

namespace chandelier::player {
namespace {

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
      options.width > largest_picture || options.height > largest_picture)
    throw UsageError(fmt::format("--size: must be WIDTHxHEIGHT, each from 1 to {} ({})", largest_picture, text));
}

void read_exposure(const std::string& text, Options& options) {
  if (text == "auto") return;
  float ev = 0.0f;
  if (!CLI::detail::lexical_cast(text, ev) || !(std::abs(ev) <= 100.0f))
    throw UsageError(fmt::format("--exposure: must be auto or a number of stops from -100 to 100 ({})", text));
  options.exposure_ev = ev;
}

void read_ambient(const std::string& text, Options& options) {
  const auto comma = text.find(',');
  const bool is_one = comma == std::string::npos;
  float up = 0.0f, down = 0.0f;
  const auto is_radiance = [](float value) { return value >= 0.0f && value <= 1e6f; };  // "nan" is none
  if (!CLI::detail::lexical_cast(text.substr(0, comma), up) || !is_radiance(up) ||
      (!is_one && (!CLI::detail::lexical_cast(text.substr(comma + 1), down) || !is_radiance(down))))
    throw UsageError(fmt::format("--ambient: must be a radiance from 0 to 1e6, or two as UP,DOWN ({})", text));
  options.ambient = is_one ? Ambient::constant(up) : Ambient::between(up, down);
}

void read_anisotropy(const std::string& text, Options& options) {
  if (text == "auto") return;
  float samples = 0.0f;
  if (!CLI::detail::lexical_cast(text, samples) || !(samples >= 1.0f && samples <= 16.0f))
    throw UsageError(fmt::format("--anisotropy: must be auto or a number from 1 to 16 ({})", text));
  options.anisotropy = samples;
}

void read_headlight(const std::string& text, Options& options) {
  if (text == "auto") return;
  float strength = text == "on" ? headlight_on : 0.0f;
  const bool is_named = text == "on" || text == "off";
  if (!is_named && (!CLI::detail::lexical_cast(text, strength) || !(strength >= 0.0f && strength <= 1e6f)))
    throw UsageError(fmt::format("--headlight: must be auto, on, off or a strength from 0 to 1e6 ({})", text));
  options.headlight = strength;
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

// The text has been checked against the setting's answers or limits.
template <typename Value>
void read_setting(const Setting& setting, const std::string& text, Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    set_by_name(value, text);
  } else if constexpr (std::is_arithmetic_v<Value>) {
    if (!CLI::detail::lexical_cast(text, value))
      throw UsageError(fmt::format("--{}: must be a whole number {} ({})", setting.option, setting.range_text, text));
    value *= static_cast<Value>(setting.scale);
  }
}

bool is_typed(const Typed& typed, std::string_view option) {
  for (size_t i = 0; i < typed.settings.size(); ++i)
    if (recipe_settings()[i].option == option) return !typed.settings[i].empty();
  return false;
}

NamedRecipe make_recipe(const std::string& preset_name, const Typed& typed) {
  const auto all = presets();
  const auto preset = std::find_if(all.begin(), all.end(), [&](const Preset& p) { return p.name == preset_name; });
  if (preset == all.end())
    throw UsageError(
        fmt::format("no such preset: must be one of {} ({})", fmt::join(preset_names(), ", "), preset_name));
  Recipe recipe = preset->recipe;
  for (size_t i = 0; i < typed.answers.size(); ++i)
    if (!typed.answers[i].empty()) set_answer(recipe, i, typed.answers[i]);
  for (size_t i = 0; i < typed.settings.size(); ++i)
    if (!typed.settings[i].empty())
      with_setting(recipe, i, [&](auto& value) { read_setting(recipe_settings()[i], typed.settings[i], value); });
  if (const auto reason = refusal(recipe)) throw UsageError(fmt::format("preset {}: {}", preset_name, *reason));
#ifndef CHANDELIER_EMBREE
  if (recipe.filter == Filter::rays)
    throw UsageError(fmt::format("preset {}: this build has no rays, since it has no Embree", preset_name));
#endif
  return {preset_name, recipe};
}

// A side of a comparison. Filter and deliver do not apply to truth, only to the other side.
NamedRecipe make_side(const std::string& preset_name, Typed typed) {
  const NamedRecipe preset = make_recipe(preset_name, Typed{.answers = std::vector<std::string>(typed.answers.size())});
  for (size_t i = 0; i < typed.answers.size(); ++i)
    if (traces_rays(preset) && (stage_choices()[i].stage == "filter" || stage_choices()[i].stage == "deliver"))
      typed.answers[i].clear();
  return make_recipe(preset_name, typed);
}

void read_budget(const Typed& typed, Options& options) {
  if (typed.max_shadow_maps) options.budget.max_shadow_maps = *typed.max_shadow_maps;
  if (typed.max_shadow_bytes) options.budget.max_shadow_bytes = uint64_t{*typed.max_shadow_bytes} << 20;
  options.budget.max_error = typed.max_error;
  if (!options.budget.is_given()) return;
  const std::string_view option = typed.max_shadow_maps    ? "--max-shadow-maps"
                                  : typed.max_shadow_bytes ? "--max-shadow-bytes"
                                                           : "--max-error";
  options.budget.d_init_is_least = is_typed(typed, "d-init");
  if (options.budget.d_init_is_least && typed.max_error)
    throw UsageError("--max-error: cannot be used with --d-init, since it chooses d-init itself");
  if (options.budget.d_init_is_least &&
      std::any_of(options.recipes.begin(), options.recipes.end(),
                  [](const NamedRecipe& each) { return each.recipe.select == Select::error_driven; }))
    throw UsageError(fmt::format("{}: cannot be used with --d-init where lights are selected by error", option));
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
  if (typed.keep_shadow_maps)
    throw UsageError(
        "--compare: cannot be used with --keep-shadow-maps, which would let one side use the other's maps");
  for (size_t i = 0; i < typed.answers.size(); ++i)
    if (stage_choices()[i].stage == "select" && !typed.answers[i].empty())
      throw UsageError("--compare: cannot be used with --select, which would make both sides select alike");
  options.mode = Mode::compare;
  options.report = typed.report;
  options.recipes = {make_side(typed.compare.substr(0, comma), typed),
                     make_side(typed.compare.substr(comma + 1), typed)};
}

NamedRecipe single_recipe(const Typed& typed) {
  return make_recipe(typed.preset.empty() ? std::string(presets().front().name) : typed.preset, typed);
}

void read_path_mode(const Typed& typed, Options& options) {
  if (typed.report.empty()) throw UsageError("--path: needs --report DIR for what it writes");
  if (!typed.compare.empty()) throw UsageError("--path: cannot be used with --compare");
  if (!typed.output.empty()) throw UsageError("--path: cannot be used with --output");
  if (!typed.stats.empty()) throw UsageError("--path: cannot be used with --stats; --report DIR gets path.json");
  if (!typed.camera.empty()) throw UsageError("--path: cannot be used with --camera; the path has the cameras");
  if (typed.predict) throw UsageError("--path: cannot be used with --predict");
  if (typed.max_shadow_maps || typed.max_shadow_bytes || typed.max_error)
    throw UsageError(
        "--path: cannot be used with --max-shadow-maps, --max-shadow-bytes or --max-error, which are kept for "
        "one view");
  if (typed.frames && *typed.frames < 2)
    throw UsageError(fmt::format("--path: needs --frames of 2 or more ({})", *typed.frames));
  options.mode = Mode::path;
  options.report = typed.report;
  options.path = typed.path;
  options.recipes = {single_recipe(typed)};
}

void read_single(const Typed& typed, Options& options) {
  if (!typed.report.empty()) throw UsageError("--report: needs --compare A,B or --path FILE");
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
  options.recipes = {single_recipe(typed)};
}

Options checked(const Typed& typed) {
  Options options;
  options.device = typed.device;
  options.validation = typed.validation;
  options.keep_shadow_maps = typed.keep_shadow_maps;
  if (typed.list_devices) {
    options.mode = Mode::list_devices;
    return options;
  }
  if (typed.pack.empty()) throw UsageError("PACK is missing");
  options.pack = typed.pack;
  options.frames = typed.frames;
  read_size(typed.size, options);
  read_exposure(typed.exposure, options);
  read_ambient(typed.ambient, options);
  read_headlight(typed.headlight, options);
  read_anisotropy(typed.anisotropy, options);
  if (typed.samples != "auto") options.samples = static_cast<uint32_t>(std::stoul(typed.samples));
  read_camera(typed.camera, options);
  if (!typed.path.empty())
    read_path_mode(typed, options);
  else if (typed.compare.empty())
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
  Typed typed;
  declare_options(app, typed);
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
  settings.samples = options.samples.value_or(1);
  settings.ambient = options.ambient;
  settings.headlight = options.headlight.value_or(0.0f);
  settings.exposure_ev = options.exposure_ev;
  settings.visibility = visibility;
  settings.keep_shadow_maps = options.keep_shadow_maps;
  return settings;
}

}  // namespace chandelier::player