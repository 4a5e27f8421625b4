// SPDX-License-Identifier: Apache-2.0
// chandelier-play: draws a pack in a window, into a picture, or with two presets side by side, or predicts a frame.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

#include "player/budget.h"
#include "player/camera.h"
#include "player/compare.h"
#include "player/headless.h"
#include "player/image_files.h"
#include "player/options.h"
#include "player/path.h"
#include "player/prediction.h"
#include "player/truth.h"
#ifndef CHANDELIER_PORTABLE
#include "player/window.h"
#endif

namespace {

using namespace chandelier;
using namespace chandelier::player;

int list_devices() {
  const auto devices = gpu::list_devices();
  for (std::size_t i = 0; i < devices.size(); ++i)
    fmt::print("{}  {} ({}){}\n", i, devices[i].name, devices[i].driver,
               devices[i].unfit.empty() ? "" : ": cannot be used, " + devices[i].unfit);
  return 0;
}

// What the validation layer said, the end of the device included.
int report_validation(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) fmt::print(stderr, "chandelier-play: validation: {}\n", message);
  fmt::print(stderr, "chandelier-play: {} messages from the validation layer\n", messages.size());
  return messages.empty() ? 0 : 1;
}

using ValidationLog = std::shared_ptr<const std::vector<std::string>>;

NamedCamera camera_of(const Options& options, const pack::File& pack) {
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  return options.camera ? NamedCamera{"", *options.camera} : choose_camera(pack, options.camera_name, aspect);
}

ValidationLog draw(const Options& options, const NamedCamera& camera, const pack::File& pack) {
  gpu::DeviceOptions device_options;
  device_options.device = options.device;
  device_options.validation = options.validation;
#ifndef CHANDELIER_PORTABLE
  std::optional<Window> window;
  if (options.mode == Mode::window) {
    window.emplace(options);
    device_options.instance_extensions = window->instance_extensions();
    device_options.swapchain = true;
  }
#endif
  gpu::Device device(device_options);
  Renderer renderer(device, pack);
  const VisibilitySource visibility = visibility_for(options.recipes, pack);
  if (options.mode == Mode::headless) run_headless(options, camera, device, renderer, visibility);
  if (options.mode == Mode::compare) run_comparison(options, camera, pack, device, renderer, visibility);
  if (options.mode == Mode::path) run_path(options, device, renderer, visibility);
#ifndef CHANDELIER_PORTABLE
  const pack::BakeInfo& info = *pack.view().bake_info;
  const float scene_size_m = glm::distance(info.bounds_min_ws, info.bounds_max_ws);
  if (window) window->run(options, camera, scene_size_m, device, renderer, visibility);
#endif
  return device.validation_log();
}

int run(Options options) {
  if (options.mode == Mode::list_devices) return list_devices();
  if (options.mode == Mode::headless) check_writable(options.output);
  if (!options.stats.empty()) check_writable(options.stats);
  const pack::File pack(options.pack);
  const NamedCamera camera = camera_of(options, pack);
  if (options.mode != Mode::compare) apply_budget(options, camera, pack);
  if (options.mode == Mode::predict) {
    run_prediction(options, camera, pack);
    return 0;
  }
  const ValidationLog log = draw(options, camera, pack);
  return options.validation ? report_validation(*log) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Parsed parsed = parse_options({argv + 1, argv + argc});
    if (parsed.options) return run(*parsed.options);
    fmt::print(parsed.exit_code == 0 ? stdout : stderr, "{}\n", parsed.text);
    return parsed.exit_code;
  } catch (const std::exception& error) {
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    fmt::print(stderr, "chandelier-play: error: {}\n", line);
    return 1;
  }
}
