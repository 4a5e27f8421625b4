// SPDX-License-Identifier: Apache-2.0
// The select answer `error-driven` for one view after another: what a view's error search is asked, and its answer.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "lights/ambient.h"
#include "lights/error_selection.h"
#include "lights/light_samples.h"
#include "recipe_schema.h"
#include "view/camera.h"

namespace chandelier {

/// Where the camera is and how bright its picture: what samples are taken for.
struct SampledView {
  Camera camera;
  float aspect = 1.0f;
  Ambient ambient;
  float headlight = 0.0f;
  std::optional<float> exposure_ev;

  bool operator==(const SampledView&) const = default;
};

/// What of a world a search depends on: where instances stand, the lights in view that throw a shadow, and all that
/// throw none, each as it was when it changed last.
struct WorldKey {
  Version instances = 0;
  std::vector<LightId> in_view;  // ascending
  std::vector<std::pair<LightId, Version>> lights;

  bool operator==(const WorldKey&) const = default;
};
WorldKey world_key(const World& world, std::span<const LightId> in_view);

/// All numbers of lights but ids are indices into `key.in_view`.
struct ErrorTask {
  WorldKey key;
  SampledView view;
  Recipe recipe;
  std::vector<MapMember> clusters;      // what light clusters make of the same lights; not asked where there are limits
  std::vector<uint32_t> group_centers;  // of each light the one whose map its group shares, of one in no group anything
};

/// Points over the picture: fewer where there are many lights, so that the rays to them stay about as many.
SampleSettings sample_grid(size_t lights, const SampledView& view);

/// Keeps samples and ladder for as long as view and world stay.
class ErrorSearch {
 public:
  /// Must be outlived by `scene`.
  explicit ErrorSearch(const SampledScene& scene) : scene_(scene) {}

  /// With limits in the recipe the best that keeps them, maps before error. Without, the fewest shadow maps whose
  /// expected error, read by `recipe.filter`, is surely no more than that of the light clusters; up to 0.6 of theirs,
  /// also such as make that surer. Light clusters need a soft filter: theirs is PCSS where the recipe says hard.
  /// `lights` are the task's. Throws SearchStopped.
  std::vector<MapMember> select(const ErrorTask& task, const SampledLights& lights, const std::stop_token& stop);
  /// estimated_rmse() of `members`, read by `recipe.filter`.
  double expected_rmse(const WorldKey& key, const SampledLights& lights, const SampledView& view,
                       std::span<const MapMember> members, const Recipe& recipe);

 private:
  void sample_view(const WorldKey& key, const SampledLights& lights, const SampledView& view,
                   const std::stop_token& stop);
  void build_ladder(const ErrorTask& task, const std::stop_token& stop);
  std::vector<MapMember> within(double most_rmse, uint32_t most_maps, const Recipe& recipe,
                                const std::stop_token& stop) const;

  const SampledScene& scene_;
  WorldKey key_;
  SampledView view_;
  DynamicLights dynamic_lights_ = DynamicLights::cluster;  // the ladder's
  std::optional<LightSamples> judge_;                      // for estimates
  std::optional<LightSamples> samples_;                    // other points, for the search
  std::optional<ErrorLadder> ladder_;
};

}  // namespace chandelier
