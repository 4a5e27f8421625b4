// SPDX-License-Identifier: Apache-2.0
#include "player/live_scene.h"

#include <fmt/format.h>
#include <volk.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include "player/truth.h"

namespace chandelier::player {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds look_every{500};

void warn(const Options& options, std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  const std::string pack = options.pack.string();
  const bool is_named = why.starts_with(pack);  // by pack::Error
  fmt::print(stderr, "chandelier-play: warning: {}{}; the older one stays\n", is_named ? "" : pack + ": ", why);
}

}  // namespace

LiveScene::LiveScene(const Options& asked, std::unique_ptr<const Scene> scene, gpu::Device& device)
    : asked_(asked),
      device_(device),
      scene_(std::move(scene)),
      pack_camera_(scene_->camera.camera),
      next_look_(Clock::now() + look_every),
      seen_(scene_->stamp),
      tried_(scene_->stamp) {
  settings = put_on_device(*scene_);
}

// Two scenes may not fit on the device, so the old one is removed first. If this throws, none is there.
RenderSettings LiveScene::put_on_device(const Scene& scene) {
  device_->vkDeviceWaitIdle(device_.handle);
  on_device_.reset();
  OnDevice made{.visibility = visibility_for(scene.options.recipes, scene.world),
                .renderer = Renderer(device_, scene.world, renderer_options(scene.options))};
  RenderSettings wanted =
      render_settings(scene.options, scene.options.recipes.front().recipe, scene.camera.camera, made.visibility);
  wanted.search_beside_frames = true;
  wanted.keep_shadow_maps = true;
  made.renderer.warm_up(wanted);
  on_device_.emplace(std::move(made));
  return wanted;
}

bool LiveScene::follow() {
  if (Clock::now() < next_look_) return false;
  next_look_ = Clock::now() + look_every;
  const FileStamp stamp = stamp_of(asked_.pack);
  const bool is_still = stamp == std::exchange(seen_, stamp);  // else it may be half written
  if (!is_still || stamp == std::exchange(tried_, stamp)) return false;
  if (stamp == scene_->stamp)
    is_older_ = false;  // moved away and back
  else
    replace();
  return true;
}

void LiveScene::toggle_headlight() {
  const float strength = asked_.headlight.value_or(0.0f) > 0.0f ? *asked_.headlight : headlight_on;
  settings.headlight = settings.headlight > 0.0f ? 0.0f : strength;
  headlight_ = settings.headlight;
}

void LiveScene::replace() {
  Options options = asked_;
  options.width = settings.width;
  options.height = settings.height;
  const bool was_moved = settings.camera != pack_camera_;
  if (was_moved) options.camera = in_file(settings.camera, scene_->camera.origin_m);
  if (headlight_) options.headlight = headlight_;
  try {
    auto next = std::make_unique<const Scene>(options);
    settings = put_on_device(*next);
    scene_ = std::move(next);
    if (!was_moved) pack_camera_ = settings.camera;
    is_older_ = false;
    return;
  } catch (const std::exception& error) {
    warn(asked_, error.what());
    is_older_ = true;
  }
  if (on_device_) return;
  RenderSettings again = put_on_device(*scene_);
  again.camera = settings.camera;
  again.headlight = settings.headlight;
  again.width = settings.width;
  again.height = settings.height;
  settings = again;
}

}  // namespace chandelier::player
