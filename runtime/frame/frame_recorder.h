// SPDX-License-Identifier: Apache-2.0
// Records the stages of a frame in their order, with what they last draw with.
#pragma once

#include <map>

#include "frame/frame_resources.h"
#include "frame/renderer.h"
#include "shading/shade.h"
#include "shading/tone_map.h"
#include "shadows/deliver/visibility_pass.h"
#include "shadows/raster/caster_pass.h"
#include "stages/lookup.h"

namespace chandelier {

// A frame that is being recorded.
struct Recording {
  gpu::Commands cmd;
  FrameSlot& slot;
  const RenderSettings& settings;
  const FramePlan& plan;
};

// What frames with one number of samples in a pixel are drawn with.
struct SamplePipelines {
  gpu::Pipeline g_buffer;
  EdgePipelines edges;
};

/// Maps are kept where all of them fit the store together: else each group takes the places of the one before.
bool keeps_maps(const RenderSettings& settings, const FramePlan& plan);

/// For one renderer. Its stages wait for each other by barriers, and its frames for the frame before.
struct FrameRecorder {
  FrameRecorder(gpu::Device& on, const World& of, const RendererOptions& options);

  /// Makes what the frame needs. The frame that used the slot has finished.
  void make_room(const RenderSettings& settings, const FramePlan& plan, FrameSlot& slot);
  /// Finds places in the store for the plan's maps, and returns how many are there already.
  uint64_t place_maps(bool keep, FramePlan& plan);

  /// The whole frame, without filter rays. Throws gpu::Error: then the next frame does again what was lost.
  void record(const Recording& frame);
  /// Its parts: what the camera sees and which lights reach it; the light of one group's lights; the picture.
  void record_start(const Recording& frame);
  void record_light(const Recording& frame, const MapGroup& group);
  void record_end(const Recording& frame);
  /// Scales the last picture to the target.
  void record_target(gpu::Commands cmd, const Target& target) const;

  Edges edges(const Recording& frame);
  /// Of the lights of a group, those without shadow too. `visibility`: bytes of its visibility textures.
  GroupInput group_input(const FramePlan& plan, const MapGroup& group, const gpu::Buffer& visibility);
  /// Where `record` throws, its commands are lost: what they would have changed is done again by the next frame.
  template <typename Record>
  void undo_if_it_throws(Record record) {
    const Version uploaded = scene.instances_version;
    const bool store_is_new = resources.store.is_new;
    try {
      record();
    } catch (...) {
      scene.instances_version = uploaded;
      resources.store.is_new = store_is_new;
      resources.store.maps.forget();
      throw;
    }
  }

  gpu::Device& device;
  const World& world;
  GpuScene scene;
  CullPipelines camera_cull;
  std::map<Cull, CullPipelines> cull;  // made when first needed
  CasterPipelines casters;
  gpu::Pipeline g_buffer;
  std::map<uint32_t, SamplePipelines> of_samples;  // 2 or more; made when first needed
  LookupAnswers lookup;
  GroupPipelines group_pipelines;
  TonePipelines tone;
  FrameResources resources;

 private:
  void record_uploads(const Recording& frame);
  void record_device_plan(const Recording& frame);
  void record_shadow_maps(const Recording& frame, uint32_t number);
  const SamplePipelines& pipelines_of(uint32_t samples);
};

}  // namespace chandelier
