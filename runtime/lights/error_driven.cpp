// SPDX-License-Identifier: Apache-2.0
#include "lights/error_driven.h"

#include <algorithm>
#include <cmath>

namespace chandelier {
namespace {

constexpr float lights_times_points = 3e5f;
constexpr float fewest_rows = 36.0f, most_rows = 108.0f;
constexpr uint32_t scatter_of_search = 1;
// Of the error that clusters are expected to make. What is expected of a selection may be too low by a third; what more
// maps would take away of that is worth a few, but not as many as clusters have (ERROR_SELECTION.md).
constexpr double in_hand = 0.85;
constexpr double amply_in_hand = 0.65;

constexpr double invisible_rmse = 5e-4;  // an eighth of what a byte of a channel holds

uint32_t map_count(std::span<const MapMember> members) {
  uint32_t maps = 0;
  for (const MapMember& member : members) maps += member.light == member.center;
  return maps;
}

}  // namespace

SampleSettings sample_grid(size_t lights, const SampledView& view) {
  const float points = lights_times_points / static_cast<float>(std::max<size_t>(1, lights));
  const float rows = std::clamp(std::sqrt(points * 9.0f / 16.0f), fewest_rows, most_rows);
  return {.columns = static_cast<uint32_t>(rows * 16.0f / 9.0f),
          .rows = static_cast<uint32_t>(rows),
          .ambient = view.ambient,
          .headlight = view.headlight,
          .exposure_ev = view.exposure_ev};
}

void ErrorDriven::look(std::span<const uint32_t> in_view, const SampledView& view) {
  if (judge_ && view == view_ && std::equal(in_view.begin(), in_view.end(), in_view_.begin(), in_view_.end())) return;
  ladder_.reset();
  view_ = view;
  in_view_.assign(in_view.begin(), in_view.end());
  judge_.emplace(scene_, in_view_, view.camera, view.aspect, sample_grid(in_view.size(), view));
}

void ErrorDriven::climb(const SampledView& view, DynamicLights dynamic_lights,
                        std::span<const uint32_t> group_centers) {
  if (ladder_ && dynamic_lights_ == dynamic_lights) return;
  ladder_.reset();
  dynamic_lights_ = dynamic_lights;
  SampleSettings settings = sample_grid(in_view_.size(), view);
  settings.scatter = scatter_of_search;
  samples_.emplace(scene_, in_view_, view.camera, view.aspect, settings);
  ladder_.emplace(*samples_, dynamic_lights, group_centers);
}

// Estimates of soft filters have an error that more maps do not lower: the number of maps limits it.
std::vector<MapMember> ErrorDriven::within(double most_rmse, uint32_t most_maps, const Recipe& recipe) const {
  auto chosen = ladder_->within(most_rmse, *judge_, {recipe.filter, recipe.face_size_px});
  return map_count(chosen) <= most_maps ? chosen : ladder_->with_at_most(most_maps);
}

std::vector<MapMember> ErrorDriven::select(std::span<const uint32_t> in_view, std::span<const MapMember> clusters,
                                           std::span<const uint32_t> group_centers, const SampledView& view,
                                           const Recipe& recipe) {
  look(in_view, view);
  climb(view, recipe.dynamic_lights, group_centers);
  const uint32_t most_maps = recipe.max_maps.value_or(UINT32_MAX);
  if (recipe.max_rmse) return within(*recipe.max_rmse, most_maps, recipe);
  if (recipe.max_maps) return ladder_->with_at_most(most_maps);
  const Filter soft = recipe.filter == Filter::hard ? Filter::pcss : recipe.filter;
  const double target = estimated_rmse(*judge_, clusters, {soft, recipe.face_size_px});
  const uint32_t most = map_count(clusters);
  const auto maps_within = [&](double share) {
    return map_count(within(std::max(share * target, invisible_rmse), most, recipe));
  };
  const uint32_t ample = std::min(maps_within(amply_in_hand), most * 3 / 5);
  return ladder_->with_at_most(std::max(maps_within(in_hand), ample));
}

double ErrorDriven::expected_rmse(std::span<const uint32_t> in_view, std::span<const MapMember> members,
                                  const SampledView& view, const Recipe& recipe) {
  look(in_view, view);
  return estimated_rmse(*judge_, members, {recipe.filter, recipe.face_size_px});
}

}  // namespace chandelier
