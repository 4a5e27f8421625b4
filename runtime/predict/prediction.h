// SPDX-License-Identifier: Apache-2.0
// What a frame will take, from the pack alone: no device, nothing drawn.
#pragma once

#include "frame/frame_plan.h"
#include "frame/frame_stats.h"
#include "lights/surroundings.h"

namespace chandelier {

struct Prediction {
  FramePlan plan;
  FrameStats stats;  // counters only
};

/// Predicts frames of one pack.
class Predictor {
 public:
  /// What `pack` points to must outlive it.
  explicit Predictor(const pack::View& pack);

  /// Lights, shadow maps and views alone: cheap enough to try many settings. The counters of draws and triangles are 0.
  Prediction plan(const RenderSettings& settings);
  /// Those of plan(), with a map for each.
  LightList lights_in_view(const RenderSettings& settings) const;
  /// Of shadow maps of plan().
  ShadowMapCounter counter(const RenderSettings& settings) const { return {pack_.lights, settings}; }
  /// All counters of a frame.
  Prediction predict(const RenderSettings& settings);
  /// Of a frame planned with these settings: RMSE of the shown picture, 0 to 1, against one hard shadow map for each
  /// light (lights/ERROR_SELECTION.md).
  double expected_rmse(const RenderSettings& settings, const FramePlan& plan);

 private:
  pack::View pack_;
  Bounds bounds_;
  Surroundings surroundings_;
};

}  // namespace chandelier
