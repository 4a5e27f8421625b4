// SPDX-License-Identifier: Apache-2.0
// What a frame will take, from the pack alone: no device, nothing drawn.
#pragma once

#include <optional>

#include "frame/frame_plan.h"
#include "frame/frame_stats.h"
#include "lights/walls.h"
#include "rays/pack_rays.h"

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
  Predictor(const Predictor&) = delete;

  /// Lights, shadow maps and views alone: cheap enough to try many settings. The counters of draws and triangles are 0.
  Prediction plan(const RenderSettings& settings);
  /// All counters of a frame.
  Prediction predict(const RenderSettings& settings);

 private:
  pack::View pack_;
  Bounds bounds_;
  std::optional<rays::PackRays> rays_;  // made when a recipe first asks for walls
  std::optional<lights::Walls> walls_;
};

}  // namespace chandelier
