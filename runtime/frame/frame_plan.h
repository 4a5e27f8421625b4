// SPDX-License-Identifier: Apache-2.0
// What the CPU decides before a frame is recorded: lights, shadow maps, their views, and rounds. Needs no device, so
// that a frame's cost can be told without one.
#pragma once

#include "frame/frame_stats.h"
#include "frame/render_settings.h"
#include "frame/rounds.h"
#include "lights/light_list.h"
#include "scene/gpu_scene.h"

namespace chandelier {

struct FramePlan {
  Recipe recipe;  // as drawn: the reference's where light clusters would not pay
  LightList list;
  std::vector<frame::ShadowView> views;  // of all maps, then the camera's
  std::vector<Round> rounds;
  frame::ViewConstants view;
  double select_ms = 0.0;
  double project_ms = 0.0;
};

/// `surroundings` are needed as select_lights() needs them.
FramePlan plan_frame(std::span<const pack::Light> lights, const Bounds& bounds, const RenderSettings& settings,
                     const RoundLimits& limits, Surroundings* surroundings);

/// What is known of a frame before it is drawn: all but times, exposure, draws and triangles. `lights`: in the pack.
FrameStats planned_stats(const FramePlan& plan, const RenderSettings& settings, uint64_t lights);

}  // namespace chandelier
