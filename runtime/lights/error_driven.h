// SPDX-License-Identifier: Apache-2.0
// The select answer `error-driven` for frame after frame: remembers what it found as long as nothing moves.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "frame/camera.h"
#include "frame/recipe.h"
#include "lights/error_selection.h"
#include "lights/light_samples.h"

namespace chandelier {

/// Where the camera is and how bright its picture: what samples are taken for.
struct SampledView {
  Camera camera;
  float aspect = 1.0f;
  float ambient = 0.0f;
  float headlight = 0.0f;
  std::optional<float> exposure_ev;

  bool operator==(const SampledView&) const = default;
};

/// Points over the picture: fewer where there are many lights, so that the rays to them stay about as many.
SampleSettings sample_grid(size_t lights, const SampledView& view);

class ErrorDriven {
 public:
  /// What `pack` points to, and `rays` through it, must outlive this.
  ErrorDriven(const pack::View& pack, const rays::PackRays& rays) : scene_(pack, rays) {}

  /// With limits in the recipe the best that keeps them, maps before error; `clusters` are not asked then. Without, the
  /// fewest shadow maps whose expected error, read by `recipe.filter`, is surely no more than that of `clusters`; up to
  /// 0.6 of theirs, also such as make that surer. Clusters need a soft filter: theirs is PCSS where the recipe says
  /// hard. All numbers of lights are indices into `in_view`, numbers in the pack in
  /// ascending order.
  /// `group_centers`: of each light the one whose map its group shares, of a light in no group anything.
  std::vector<MapMember> select(std::span<const uint32_t> in_view, std::span<const MapMember> clusters,
                                std::span<const uint32_t> group_centers, const SampledView& view, const Recipe& recipe);
  /// estimated_rmse() of `members`, read by `recipe.filter`; numbers as above.
  double expected_rmse(std::span<const uint32_t> in_view, std::span<const MapMember> members, const SampledView& view,
                       const Recipe& recipe);

 private:
  void look(std::span<const uint32_t> in_view, const SampledView& view);
  void climb(const SampledView& view, DynamicLights dynamic_lights, std::span<const uint32_t> group_centers);
  std::vector<MapMember> within(double most_rmse, uint32_t most_maps, const Recipe& recipe) const;

  SampledScene scene_;
  std::vector<uint32_t> in_view_;
  SampledView view_;
  DynamicLights dynamic_lights_ = DynamicLights::cluster;  // the ladder's
  std::optional<LightSamples> judge_;                      // for estimates
  std::optional<LightSamples> samples_;                    // other points, for the search
  std::optional<ErrorLadder> ladder_;
};

}  // namespace chandelier
