// SPDX-License-Identifier: Apache-2.0
#include "lights/light_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "light_near.h"
#include "lights/mean_materials.h"
#include "lights/pack_lights.h"
#include "lights/search_stopped.h"

namespace chandelier {
namespace {

constexpr float far_away_m = 1e6f;
constexpr float lift = 5e-4f;         // off the surface, of the distance to the eye: well above a ray's own rounding
constexpr float middle_grey = 0.18f;  // shading/exposure.comp
constexpr float darkest = 1e-6f;      // shading/exposure.comp
constexpr uint32_t most_backs = 64;   // between the eye and what it sees

// 0 to 1, the same for the same number: points lie anywhere in their cells, so that no pattern of the scene's meets the
// grid's. Integer hash by Ettinger ("triple32", first two rounds).
float scattered(uint32_t x) {
  x = (x ^ x >> 17) * 0xed5ad4bbu;
  x = (x ^ x >> 11) * 0xac4c1b51u;
  return static_cast<float>((x ^ x >> 15) >> 8) * 0x1p-24f;
}

float luminance(const glm::vec3& radiance) {
  return glm::dot(radiance, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

}  // namespace

// shading/shade.comp:unshadowed, shading/brdf.glsl:distance_falloff.
Incoming incoming(const pack::Light& light, const glm::vec3& p) {
  const glm::vec3 radiant = light.color * light.intensity;
  if (is_directional(light)) return {radiant, -light.direction_ws};
  const glm::vec3 d = light.position_ws - p;
  const float distance = glm::length(d);
  const glm::vec3 to_light = d / std::max(distance, 1e-6f);
  const float ratio = distance / light.range_m;
  float falloff = glm::clamp(1.0f - ratio * ratio * ratio * ratio, 0.0f, 1.0f) / std::max(distance * distance, 1e-4f);
  if (light.type == pack::LightType::spot) {
    const float scale = 1.0f / std::max(0.001f, light.inner_cone_cos - light.outer_cone_cos);
    const float cone = glm::clamp((glm::dot(light.direction_ws, -to_light) - light.outer_cone_cos) * scale, 0.0f, 1.0f);
    falloff *= cone * cone;
  }
  return {radiant * falloff, to_light};
}

// How far from the light something first throws a shadow on a place; nothing where nothing does. What is nearer to the
// light than the near plane of its shadow map throws none.
static std::optional<float> first_caster_m(const rays::PackRays& rays, const pack::Light& light,
                                           const glm::vec3& place_ws) {
  const glm::vec3 d = place_ws - light.position_ws;
  const float distance = glm::length(d);
  const float near_m = pack::shadow_near_m(light);
  if (distance <= near_m) return std::nullopt;
  const glm::vec3 from = light.position_ws + d * (near_m / distance);
  const float way_m = distance - near_m - rays::PackRays::end_gap_m(from, place_ws);
  const auto hit = rays.first_hit(from, d / distance, std::max(way_m, 1e-6f), rays::Meets::casters);
  return hit ? std::optional(hit->distance_m + near_m) : std::nullopt;
}

bool sees(const rays::PackRays& rays, const pack::Light& light, const glm::vec3& place_ws) {
  if (is_directional(light)) return !rays.first_hit(place_ws, -light.direction_ws, far_away_m, rays::Meets::casters);
  return !first_caster_m(rays, light, place_ws);
}

std::optional<rays::Hit> first_seen(const SampledScene& scene, const glm::vec3& eye_ws, const glm::vec3& way,
                                    uint64_t& rays_cast) {
  float passed_m = 0.0f;
  for (uint32_t backs = 0; backs < most_backs; ++backs) {
    auto hit = scene.rays.first_hit(eye_ws + way * passed_m, way, far_away_m);
    ++rays_cast;
    if (!hit) return hit;
    hit->distance_m += passed_m;
    if (scene.materials[hit->material].double_sided || glm::dot(hit->normal_ws, way) <= 0.0f) return hit;
    passed_m = hit->distance_m + rays::PackRays::end_gap_m(eye_ws, eye_ws + way * hit->distance_m);
  }
  return std::nullopt;
}

SeenPlace seen_place(const rays::Hit& hit, const glm::vec3& eye_ws, const glm::vec3& way) {
  const glm::vec3 normal = glm::dot(hit.normal_ws, way) > 0.0f ? -hit.normal_ws : hit.normal_ws;
  return {eye_ws + way * hit.distance_m + normal * (lift * hit.distance_m), normal};
}

SampledLights sampled_lights(const World& world, std::span<const LightId> ids) {
  SampledLights lights;
  for (const LightId id : ids) lights.shadowed.push_back(world.lights()[id]);
  for (LightId id = 0; id < world.lights().size(); ++id)
    if (world.has_light(id) && world.lights()[id].shadowless != 0) lights.shadowless.push_back(world.lights()[id]);
  return lights;
}

LightSamples::LightSamples(const SampledScene& scene, SampledLights lights, const Camera& camera, float aspect,
                           const SampleSettings& settings, const std::stop_token& stop)
    : scene_(scene), lights_(std::move(lights)) {
  place_points(camera, aspect, settings, stop);
  sees_.assign(lights_.shadowed.size() * points_.size(), unknown);
  light_points(camera, stop);
  expose(settings.exposure_ev);
}

void LightSamples::place_points(const Camera& camera, float aspect, const SampleSettings& settings,
                                const std::stop_token& stop) {
  const CameraAxes axes = axes_of(camera);
  const float half_height = std::tan(camera.yfov_rad * 0.5f);
  cell_count_ = settings.columns * settings.rows;
  for (uint32_t cell = 0; cell < cell_count_; ++cell) {
    stop_if_asked(stop);
    const uint32_t place = 2 * (cell + settings.scatter * cell_count_);
    const float x =
        (static_cast<float>(cell % settings.columns) + scattered(place)) / static_cast<float>(settings.columns);
    const float y =
        (static_cast<float>(cell / settings.columns) + scattered(place + 1)) / static_cast<float>(settings.rows);
    const glm::vec3 way = glm::normalize(axes.forward + axes.right * ((2.0f * x - 1.0f) * half_height * aspect) +
                                         axes.up * ((1.0f - 2.0f * y) * half_height));
    const auto hit = first_seen(scene_, camera.eye_ws, way, rays_cast_);
    if (!hit || scene_.materials[hit->material].unlit) continue;
    const SeenPlace seen = seen_place(*hit, camera.eye_ws, way);
    const MeanMaterial& material = scene_.materials[hit->material];
    const glm::vec3 reflected_of_all =
        settings.ambient.at(seen.normal_ws) - settings.headlight * glm::dot(seen.normal_ws, way);
    const glm::vec3 dark = material.emissive + reflected_of_all * material.base_color;
    points_.push_back(
        {.position_ws = seen.position_ws, .normal_ws = seen.normal_ws, .unshadowable = dark, .reference = dark});
    material_.push_back(hit->material);
  }
}

// What the light adds to a point that it sees.
glm::vec3 LightSamples::added_by(const pack::Light& light, uint32_t p, const Camera& camera) const {
  const Point& point = points_[p];
  const Incoming in = incoming(light, point.position_ws);
  const float n_dot_l = glm::dot(point.normal_ws, in.to_light);
  if (n_dot_l <= 0.0f || luminance(in.illuminance) <= 0.0f) return glm::vec3(0.0f);
  const glm::vec3 to_eye = glm::normalize(camera.eye_ws - point.position_ws);
  return in.illuminance * n_dot_l * reflected(scene_.materials[material_[p]], point.normal_ws, to_eye, in.to_light);
}

void LightSamples::light_points(const Camera& camera, const std::stop_token& stop) {
  contributions_.resize(lights_.shadowed.size());
  for (uint32_t i = 0; i < lights_.shadowed.size(); ++i) {
    stop_if_asked(stop);
    for (uint32_t p = 0; p < points_.size(); ++p) {
      const glm::vec3 added = added_by(light(i), p, camera);
      if (luminance(added) <= 0.0f) continue;
      contributions_[i].push_back({p, added});
      if (sees(i, p)) points_[p].reference += added;
    }
  }
  for (const pack::Light& shadowless : lights_.shadowless) {
    stop_if_asked(stop);
    for (uint32_t p = 0; p < points_.size(); ++p) {
      const glm::vec3 added = added_by(shadowless, p, camera);
      points_[p].unshadowable += added;
      points_[p].reference += added;
    }
  }
}

// shading/exposure.comp: the mean of the square roots of luminance becomes middle grey.
void LightSamples::expose(const std::optional<float>& exposure_ev) {
  double sum = 0.0;
  uint32_t count = 0;
  for (const Point& point : points_) {
    const float y = luminance(point.reference);
    if (y <= darkest) continue;
    sum += std::sqrt(y);
    ++count;
  }
  exposure_ev_ = exposure_ev ? *exposure_ev
                 : count > 0 ? std::log2(middle_grey) - 2.0f * static_cast<float>(std::log2(sum / count))
                             : 0.0f;
  const float exposure = std::exp2(exposure_ev_);
  for (Point& point : points_) {
    point.unshadowable *= exposure;
    point.reference *= exposure;
  }
  for (auto& of_light : contributions_)
    for (Contribution& contribution : of_light) contribution.radiance *= exposure;
}

bool LightSamples::is_lit(uint32_t i, const glm::vec3& place_ws) const {
  ++rays_cast_;
  return chandelier::sees(scene_.rays, light(i), place_ws);
}

float LightSamples::blocked_at(uint32_t i, const glm::vec3& place_ws) const {
  ++rays_cast_;
  const auto caster_m = first_caster_m(scene_.rays, light(i), place_ws);
  return caster_m ? *caster_m / glm::distance(place_ws, light(i).position_ws) : 1.0f;
}

}  // namespace chandelier
