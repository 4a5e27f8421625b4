// SPDX-License-Identifier: Apache-2.0
// Medians and JSON of the times and counters of frames.
#include "player/stats.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace chandelier::player {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array all_counters{
    Counter{"lights", &FrameStats::lights, false},
    Counter{"lights_in_view", &FrameStats::lights_in_view, false},
    Counter{"shadowless_in_view", &FrameStats::shadowless_in_view, false},
    Counter{"light_clusters", &FrameStats::light_clusters, false},
    Counter{"reference_path", &FrameStats::reference_path, false},
    Counter{"shadow_maps", &FrameStats::shadow_maps, false},
    Counter{"shadow_maps_kept", &FrameStats::shadow_maps_kept, false},
    Counter{"shadow_views", &FrameStats::shadow_views, false},
    Counter{"shadow_triangles", &FrameStats::shadow_triangles, false},
    Counter{"shadow_draws", &FrameStats::shadow_draws, false},
    Counter{"shadow_bytes", &FrameStats::shadow_bytes, true},
    Counter{"shadow_pool_bytes", &FrameStats::shadow_pool_bytes, true},
    Counter{"shadow_rounds", &FrameStats::shadow_rounds, false},
    Counter{"shadow_overflow_passes", &FrameStats::shadow_overflow_passes, false},
    Counter{"visibility_bytes", &FrameStats::visibility_bytes, true},
    Counter{"visibility_pool_bytes", &FrameStats::visibility_pool_bytes, true},
    Counter{"edge_pixels", &FrameStats::edge_pixels, false, false},
    Counter{"edge_surfaces", &FrameStats::edge_surfaces, false, false},
    Counter{"sample_bytes", &FrameStats::sample_bytes, true, false},
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

template <typename Get>
double median_of(std::span<const FrameStats> frames, Get get) {
  std::vector<double> values;
  for (const FrameStats& frame : frames) values.push_back(get(frame));
  return median(std::move(values));
}

Json camera_json(const NamedCamera& named) {
  const Camera& camera = named.camera;
  const auto vec = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
  Json json = {{"name", named.name},
               {"eye_m", vec(in_file(camera, named.origin_m).eye_m)},
               {"forward_ws", vec(camera.forward_ws)},
               {"up_ws", vec(camera.up_ws)},
               {"yfov_deg", camera.yfov_rad * 180.0f / std::numbers::pi_v<float>}};
  if (named.chosen != ChosenView::asked) json["chosen"] = name_of(named.chosen);
  return json;
}

template <typename Value>
void put(Json& json, const std::string& name, const Value& value) {
  if constexpr (std::is_enum_v<Value>)
    json[name] = name_of(value);
  else
    json[name] = value;
}

template <typename Value>
void put(Json& json, const std::string& name, const std::optional<Value>& value) {
  if (value) json[name] = *value;
}

Json recipe_json(const Recipe& recipe) {
  Json json = Json::object();
  const auto stages = stage_choices();
  for (size_t i = 0; i < stages.size(); ++i) json[std::string(stages[i].stage)] = answer(recipe, i);
  Json& values = json["settings"] = Json::object();
  for (size_t i = 0; i < recipe_settings().size(); ++i)
    with_setting(recipe, i, [&](const auto& value) { put(values, std::string(recipe_settings()[i].name), value); });
  return json;
}

Json size_json(const RenderSettings& settings) {
  return {{"width", settings.width}, {"height", settings.height}};
}

// A number where one says it all.
Json ambient_json(const Ambient& ambient) {
  const glm::vec3& first = ambient.coefficients[0];
  if (ambient.is_constant() && first.x == first.y && first.y == first.z) return first.x;
  Json json = Json::array();
  for (const glm::vec3& c : ambient.coefficients) json.push_back({c.x, c.y, c.z});
  return json;
}

Json counters_json(const FrameStats& stats, bool are_predicted) {
  Json counts = Json::object();
  for (const Counter& counter : counters())
    if (counter.is_predicted || !are_predicted) counts[std::string(counter.name)] = stats.*counter.value;
  return counts;
}

Json shared_maps_json(const std::vector<SharedMap>& shared) {
  Json json = Json::array();
  for (const SharedMap& each : shared) json.push_back({{"light", each.light}, {"map_of", each.map_of}});
  return json;
}

Json centers_json(const std::vector<uint32_t>& centers) {
  Json json = Json::array();
  for (const uint32_t center : centers) json.push_back(center == pack::none ? Json() : Json(center));
  return json;
}

}  // namespace

std::span<const Counter> counters() {
  return all_counters;
}

FrameStats medians(std::span<const FrameStats> frames) {
  FrameStats result = frames.back();
  result.frame_ms = median_of(frames, [](const FrameStats& f) { return f.frame_ms; });
  for (size_t i = 0; i < result.stages.size(); ++i) {
    result.stages[i].gpu_ms = median_of(frames, [i](const FrameStats& f) { return f.stages.at(i).gpu_ms; });
    result.stages[i].cpu_ms = median_of(frames, [i](const FrameStats& f) { return f.stages.at(i).cpu_ms; });
  }
  return result;
}

Json to_json(const Run& run) {
  Json stages = Json::array();
  for (const StageTime& stage : run.stats.stages)
    stages.push_back({{"name", stage.name}, {"gpu_ms", stage.gpu_ms}, {"cpu_ms", stage.cpu_ms}});
  Json json = {{"pack", run.pack},
               {"device", run.device},
               {"driver", run.driver},
               {"size", size_json(run.settings)},
               {"camera", camera_json(run.camera)},
               {"preset", run.preset},
               {"recipe", recipe_json(run.settings.recipe)},
               {"ambient", ambient_json(run.settings.ambient)},
               {"headlight", run.settings.headlight},
               {"samples", run.settings.samples},
               {"exposure_ev", run.stats.exposure_ev},
               {"frames", run.frames},
               {"frame_ms", run.stats.frame_ms},
               {"stages", std::move(stages)},
               {"counters", counters_json(run.stats, false)}};
  if (!run.image.empty()) json["image"] = run.image;
  if (!run.radiance.empty()) json["radiance"] = run.radiance;
  if (run.expected_rmse) json["expected_rmse_shown"] = *run.expected_rmse;
  if (run.shared_maps) json["lights_without_own_map"] = shared_maps_json(*run.shared_maps);
  return json;
}

Json prediction_json(const Run& run) {
  return {{"pack", run.pack},
          {"size", size_json(run.settings)},
          {"camera", camera_json(run.camera)},
          {"preset", run.preset},
          {"recipe", recipe_json(run.settings.recipe)},
          {"counters", counters_json(run.stats, true)},
          {"expected_rmse_shown", *run.expected_rmse},
          {"lights_without_own_map", shared_maps_json(*run.shared_maps)},
          {"center_of_light", centers_json(run.stats.centers)}};
}

}  // namespace chandelier::player
