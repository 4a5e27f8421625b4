// SPDX-License-Identifier: Apache-2.0
// What a frame will take, without a device and without drawing it.
#pragma once

#include "frame/frame_plan.h"
#include "frame/frame_stats.h"
#include "lights/surroundings.h"

namespace chandelier {

struct Prediction {
  FramePlan plan;
  FrameStats stats;  // counters only
};

/// Predicts frames of a world as it is when asked.
class Predictor {
 public:
  /// `world` must outlive it.
  explicit Predictor(const World& world, MeanMaterialsOf materials_of = mean_materials)
      : world_(world), surroundings_(world, materials_of) {}
  explicit Predictor(World&& world) = delete;

  /// Lights, shadow maps and views alone: cheap enough to try many settings. The counters of draws and triangles are 0.
  Prediction plan(const RenderSettings& settings);
  /// Those of plan(), with a map for each.
  LightList lights_in_view(const RenderSettings& settings) const;
  /// Of shadow maps of plan().
  ShadowMapCounter counter(const RenderSettings& settings) const { return {world_, settings}; }
  /// All counters of a frame.
  Prediction predict(const RenderSettings& settings);
  /// Of a frame planned with these settings: RMSE of the shown picture, 0 to 1, against one hard shadow map for each
  /// light (lights/ERROR_SELECTION.md).
  double expected_rmse(const RenderSettings& settings, const FramePlan& plan);

 private:
  const World& world_;
  Surroundings surroundings_;
};

}  // namespace chandelier
