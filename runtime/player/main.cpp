// SPDX-License-Identifier: Apache-2.0
// chandelier-play: draws a pack in a window, into a picture, or with two presets side by side, or predicts a frame.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include "player/compare.h"
#include "player/headless.h"
#include "player/image_files.h"
#include "player/options.h"
#include "player/path.h"
#include "player/prediction.h"
#include "player/scene.h"
#include "player/truth.h"
#ifndef CHANDELIER_PORTABLE
#include "player/live_scene.h"
#include "player/window.h"
#endif

namespace {

using namespace chandelier;
using namespace chandelier::player;

int list_devices() {
  const auto devices = gpu::list_devices();
  for (size_t i = 0; i < devices.size(); ++i)
    fmt::print("{}  {} ({}){}\n", i, devices[i].name, devices[i].driver,
               devices[i].unfit.empty() ? "" : ": cannot be used, " + devices[i].unfit);
  return 0;
}

// Messages of the validation layer, those at the device's destruction included.
int report_validation(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) fmt::print(stderr, "chandelier-play: validation: {}\n", message);
  fmt::print(stderr, "chandelier-play: {} messages from the validation layer\n", messages.size());
  return messages.empty() ? 0 : 1;
}

using ValidationLog = std::shared_ptr<const std::vector<std::string>>;

ValidationLog draw(Options asked, std::unique_ptr<Scene> scene) {
  const auto choose_samples = [&](const gpu::Device& device) {
    if (!asked.samples) asked.samples = scene->options.samples = default_samples(device, asked.width, asked.height);
  };
  gpu::DeviceOptions device_options;
  device_options.device = asked.device;
  device_options.validation = asked.validation;
#ifndef CHANDELIER_PORTABLE
  if (asked.mode == Mode::window) {
    Window window(asked);
    device_options.instance_extensions = window.instance_extensions();
    device_options.swapchain = true;
    gpu::Device device(device_options);
    choose_samples(device);
    LiveScene live(asked, std::move(scene), device);
    window.run(live, device);
    return device.validation_log();
  }
#endif
  gpu::Device device(device_options);
  choose_samples(device);
  const auto& [stamp, pack, world, options, camera] = *scene;
  Renderer renderer(device, world, renderer_options(options));
  const VisibilitySource visibility = visibility_for(options.recipes, world);
  if (options.mode == Mode::headless) run_headless(options, camera, pack, device, renderer, visibility);
  if (options.mode == Mode::compare) run_comparison(options, camera, pack, world, device, renderer, visibility);
  if (options.mode == Mode::path) run_path(options, pack, device, renderer, visibility);
  return device.validation_log();
}

int run(const Options& asked) {
  if (asked.mode == Mode::list_devices) return list_devices();
  if (asked.mode == Mode::headless) check_writable(asked.output);
  if (!asked.stats.empty()) check_writable(asked.stats);
  auto scene = std::make_unique<Scene>(asked);
  if (asked.mode == Mode::predict) {
    run_prediction(scene->options, scene->camera, scene->pack, scene->world);
    return 0;
  }
  const ValidationLog log = draw(asked, std::move(scene));
  return asked.validation ? report_validation(*log) : 0;
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
