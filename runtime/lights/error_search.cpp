// SPDX-License-Identifier: Apache-2.0
#include "lights/error_search.h"

#include <algorithm>
#include <cmath>

namespace chandelier {
namespace {

constexpr float lights_times_points = 3e5f;
constexpr float usual_rows = 36.0f, most_rows = 108.0f;
// Lights that reach everything add something to every point: 16 bytes each in the samples of judge and search. Above
// 1,302 lights the usual rows would be more than this.
constexpr float most_lights_times_points = 3e6f;
constexpr float fewest_rows = 9.0f;  // 144 points; from 20,834 lights on
constexpr uint32_t scatter_of_search = 1;
// Of the error that light clusters are expected to make. What is expected of a selection may be too low by a third, so
// it aims below theirs; further below where that takes few maps (ERROR_SELECTION.md).
constexpr double share_of_cluster_error = 0.85;
constexpr double share_with_few_maps = 0.65;

constexpr double invisible_rmse = 5e-4;  // an eighth of what a byte of a channel holds

uint32_t map_count(std::span<const MapMember> members) {
  uint32_t maps = 0;
  for (const MapMember& member : members) maps += member.light == member.center;
  return maps;
}

}  // namespace

WorldKey world_key(const World& world, std::span<const LightId> in_view) {
  WorldKey key{.instances = world.instances_version(), .in_view = {in_view.begin(), in_view.end()}, .lights = {}};
  for (const LightId id : in_view) key.lights.push_back({id, world.light_version(id)});
  for (LightId id = 0; id < world.lights().size(); ++id)
    if (world.has_light(id) && world.lights()[id].shadowless != 0) key.lights.push_back({id, world.light_version(id)});
  return key;
}

SampleSettings sample_grid(size_t lights, const SampledView& view) {
  const auto rows_for = [&](float entries) {
    const float points = entries / static_cast<float>(std::max<size_t>(1, lights));
    return std::sqrt(points * 9.0f / 16.0f);
  };
  const float fewest = std::clamp(rows_for(most_lights_times_points), fewest_rows, usual_rows);
  const float rows = std::clamp(rows_for(lights_times_points), fewest, most_rows);
  return {.columns = static_cast<uint32_t>(rows * 16.0f / 9.0f),
          .rows = static_cast<uint32_t>(rows),
          .ambient = view.ambient,
          .headlight = view.headlight,
          .exposure_ev = view.exposure_ev};
}

void ErrorSearch::sample_view(const WorldKey& key, const SampledLights& lights, const SampledView& view,
                              const std::stop_token& stop) {
  if (judge_ && view == view_ && key == key_) return;
  ladder_.reset();
  judge_.reset();
  judge_.emplace(scene_, lights, view.camera, view.aspect, sample_grid(lights.shadowed.size(), view), stop);
  view_ = view;
  key_ = key;
}

void ErrorSearch::build_ladder(const ErrorTask& task, const std::stop_token& stop) {
  if (ladder_ && dynamic_lights_ == task.recipe.dynamic_lights) return;
  ladder_.reset();
  samples_.reset();
  dynamic_lights_ = task.recipe.dynamic_lights;
  SampleSettings settings = sample_grid(judge_->lights().size(), task.view);
  settings.scatter = scatter_of_search;
  const SampledLights lights = judge_->sampled_lights();
  samples_.emplace(scene_, lights, task.view.camera, task.view.aspect, settings, stop);
  ladder_.emplace(*samples_, dynamic_lights_, task.group_centers, stop);
}

// Estimates of soft filters have an error that more maps do not lower: the number of maps limits it.
std::vector<MapMember> ErrorSearch::within(double most_rmse, uint32_t most_maps, const Recipe& recipe,
                                           const std::stop_token& stop) const {
  auto chosen = ladder_->within(most_rmse, *judge_, {recipe.filter, recipe.face_size_px}, stop);
  return map_count(chosen) <= most_maps ? chosen : ladder_->with_at_most(most_maps, stop);
}

std::vector<MapMember> ErrorSearch::select(const ErrorTask& task, const SampledLights& lights,
                                           const std::stop_token& stop) {
  sample_view(task.key, lights, task.view, stop);
  build_ladder(task, stop);
  const Recipe& recipe = task.recipe;
  const uint32_t most_maps = recipe.max_maps.value_or(UINT32_MAX);
  if (recipe.max_rmse) return within(*recipe.max_rmse, most_maps, recipe, stop);
  if (recipe.max_maps) return ladder_->with_at_most(most_maps, stop);
  const Filter soft = recipe.filter == Filter::hard ? Filter::pcss : recipe.filter;
  const double target = estimated_rmse(*judge_, task.clusters, {soft, recipe.face_size_px}, stop);
  const uint32_t most = map_count(task.clusters);
  const auto maps_within = [&](double share) {
    return map_count(within(std::max(share * target, invisible_rmse), most, recipe, stop));
  };
  const uint32_t few = std::min(maps_within(share_with_few_maps), most * 3 / 5);
  return ladder_->with_at_most(std::max(maps_within(share_of_cluster_error), few), stop);
}

double ErrorSearch::expected_rmse(const WorldKey& key, const SampledLights& lights, const SampledView& view,
                                  std::span<const MapMember> members, const Recipe& recipe) {
  sample_view(key, lights, view, {});
  return estimated_rmse(*judge_, members, {recipe.filter, recipe.face_size_px});
}

}  // namespace chandelier
