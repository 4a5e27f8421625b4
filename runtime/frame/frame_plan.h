// SPDX-License-Identifier: Apache-2.0
// What the CPU decides before a frame is recorded: lights, shadow maps, their views, and the groups of maps that are
// drawn and shaded together. Needs no device, so that a frame's cost can be predicted without one.
#pragma once

#include "frame/frame_stats.h"
#include "frame/render_settings.h"
#include "lights/light_list.h"
#include "lights/map_counter.h"
#include "shadows/store/map_groups.h"
#include "world/world.h"

namespace chandelier {

struct FramePlan {
  Recipe recipe;  // as drawn: the reference's where light clusters would not pay
  LightList list;
  std::vector<frame::ShadowView> views;  // of all maps, then the camera's
  std::vector<MapGroup> groups;
  frame::ViewConstants view;
  double select_ms = 0.0;
  double project_ms = 0.0;
};

/// `surroundings` are needed as select_lights() needs them.
FramePlan plan_frame(const World& world, const RenderSettings& settings, const GroupLimits& limits,
                     Surroundings* surroundings);

/// Counts shadow_maps of planned_stats() for one d_init after another, in less time. For light clusters without walls,
/// stability or held centres, and a filter that reads maps.
class ShadowMapCounter {
 public:
  ShadowMapCounter(const World& world, const RenderSettings& settings);
  /// Any number above `most` where there are more.
  uint64_t count(float d_init_m, uint64_t most);
  /// No later d_init will be larger, which makes counting faster.
  void stay_within(float d_init_m) { maps_.stay_within(d_init_m); }

 private:
  Recipe recipe_;
  MapCounter maps_;
};

/// What is known of a frame before it is drawn: all but times, exposure, draws and triangles.
FrameStats planned_stats(const World& world, const FramePlan& plan, const RenderSettings& settings);

}  // namespace chandelier
