// SPDX-License-Identifier: Apache-2.0
// What frames draw with: images and buffers that last, and what each frame in flight has for itself.
#pragma once

#include "frame/frame_plan.h"
#include "gpu/frames.h"
#include "gpu/timers.h"
#include "scene/gpu_scene.h"
#include "shading/edges.h"
#include "shadows/cull/cull.h"
#include "shadows/deliver/visibility_pass.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

/// Of one frame in flight. It is used again when that frame has finished.
struct FrameSlot {
  explicit FrameSlot(const gpu::Device& device);
  /// The frame that used the slot has finished.
  void reset();

  gpu::UploadArena uploads;
  gpu::Retired retired;
  gpu::Timers timers;
  gpu::Buffer counters;  // frame CullCounters, read back: one for each group, then the camera's
  gpu::Buffer exposure;  // frame LuminanceSum, read back
  gpu::Buffer edges;     // frame EdgeCounters, read back
  FrameStats stats;
  size_t groups = 0;
  double record_ms = 0.0;
  bool is_read = true;  // stats are complete
};

/// Shared by all frames: each waits on the device for the one before.
struct FrameResources {
  Targets targets;
  EdgeLists edges;
  gpu::Buffer luminance_sums;
  CubeArray store;
  CullState camera_draws;
  CullState shadow_draws;
  gpu::Streamed view, lights, maps, views;
  VisibilityTextures visibility;
  gpu::Buffer counters;  // one per group, then the camera's
};

/// Lights as uploaded: those with a shadow, then those without.
size_t light_count(const FramePlan& plan);

/// Makes what the frame needs; what is there already and large enough is kept, and what is replaced is retired with the
/// slot. Throws gpu::Error.
void make_room(const gpu::Device& device, const RenderSettings& settings, const FramePlan& plan, FrameSlot& slot,
               FrameResources& resources);

}  // namespace chandelier
