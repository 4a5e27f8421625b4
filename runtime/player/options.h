// SPDX-License-Identifier: Apache-2.0
// The command line of chandelier-play, parsed and checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frame/renderer.h"
#include "player/camera.h"
#include "player/stats.h"
#include "predict/d_init_search.h"

namespace chandelier::player {

constexpr float headlight_on = 1.0f;  // as RenderSettings has it

enum class Mode { list_devices, headless, compare, path, predict, window };

struct NamedRecipe {
  std::string preset;
  Recipe recipe;                                      // the preset's, with every explicit setting applied
  std::optional<std::vector<SharedMap>> shared_maps;  // where a budget is given
  std::optional<double> expected_rmse;                // where that is one of error
};

struct Options {
  Mode mode = Mode::window;
  std::filesystem::path pack;
  std::filesystem::path output;      // Mode::headless
  std::filesystem::path stats;       // Mode::headless, Mode::predict; empty: none
  std::filesystem::path report;      // Mode::compare and Mode::path: a folder
  std::filesystem::path path;        // Mode::path: the camera's
  std::vector<NamedRecipe> recipes;  // two in Mode::compare, else one
  Budget budget;                     // of recipes whose lights share maps
  uint32_t width = 1280;
  uint32_t height = 720;
  std::string camera_name;           // empty: the pack's first
  std::optional<FileCamera> camera;  // given by numbers
  std::optional<uint32_t> frames;    // timed frames; in a window: close after so many
  std::string device;
  bool validation = false;
  bool keep_shadow_maps = false;  // from frame to frame; windows always do
  Ambient ambient;
  std::optional<float> headlight;  // absent: automatic_headlight() decides for the pack
  std::optional<float> exposure_ev;
  std::optional<uint32_t> samples;  // in a pixel; absent: as default_samples() has it for the device
  std::optional<float> anisotropy;  // absent: as RendererOptions has it
};

/// Whether visibility comes from rays on the CPU (preset truth).
inline bool traces_rays(const NamedRecipe& named) {
  return named.recipe.filter == Filter::rays;
}

/// Options, or a text to print and the exit status.
struct Parsed {
  std::optional<Options> options;
  int exit_code = 0;  // 0: help or version, in `text`; 2: usage error, one line in `text`
  std::string text;
};

/// `arguments` without the program's name.
Parsed parse_options(const std::vector<std::string>& arguments);

/// The settings of a frame with `recipe` and these options; `visibility` comes from visibility_for().
RenderSettings render_settings(const Options& options, const Recipe& recipe, const Camera& camera,
                               const VisibilitySource& visibility);

/// Samples in a pixel where none are asked for.
uint32_t default_samples(const gpu::Device& device, uint32_t width, uint32_t height);

/// Options of the pack's renderer. A long upload shows its progress on a terminal.
RendererOptions renderer_options(const Options& options);

}  // namespace chandelier::player
