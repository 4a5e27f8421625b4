// SPDX-License-Identifier: Apache-2.0
#include "lights/error_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "frame_schema.h"
#include "lights/shown_curve.h"

namespace chandelier {
namespace {

// Numbers of shadows/filter/receiver_disc.glsl and pcf.glsl.
constexpr std::array<glm::vec2, frame::poisson_taps> poisson_disc{{{0.000f, 0.000f},
                                                                   {-0.092f, -0.905f},
                                                                   {-0.698f, 0.252f},
                                                                   {0.719f, -0.070f},
                                                                   {0.477f, 0.683f},
                                                                   {-0.434f, -0.369f},
                                                                   {0.301f, -0.520f},
                                                                   {-0.165f, 0.666f}}};
constexpr float smoothing_texels = 1.5f;
constexpr float penumbra_per_d_min = 0.08f;
constexpr float raise_texels = 0.75f;  // more than the reference is raised: the rays need none for their own sake

// Two discs in the receiver's plane, one around it and one around the light. Rays join their taps.
struct Discs {
  glm::vec3 receiver_ws;
  glm::vec3 u_ws, v_ws;  // unit length
  float receiver_m;
  float light_m;
};

float largest(const glm::vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// A blocker at the part t of the way shows the light's disc, of radius R, as R * (1 - t) / t around the receiver: what
// PCSS works out (pcss.glsl:cube_pcss) these rays do by themselves. Smoothing adds to that, where the shader takes the
// larger of both.
Discs discs_at(const LightSamples::Point& point, const glm::vec3& center_ws, float radius_m,
               const ShadowReading& reading, float angle) {
  const glm::vec3 n = point.normal_ws;
  const glm::vec3 d = point.position_ws - center_ws;
  const float distance = std::max(glm::length(d), 1e-6f);
  const float texel_m = 2.0f / static_cast<float>(reading.face_size_px) * largest(d);
  const float along = glm::dot(n, d) / distance;
  const glm::vec3 t = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
  const glm::vec3 b = glm::cross(n, t);
  const bool pcss = reading.filter == Filter::pcss;
  const float wide = pcss ? 0.0f : std::min(penumbra_per_d_min * radius_m, 0.5f * distance);
  return {
      .receiver_ws = point.position_ws + n * (raise_texels * texel_m * std::sqrt(std::max(0.0f, 1.0f - along * along))),
      .u_ws = std::cos(angle) * t + std::sin(angle) * b,
      .v_ws = std::cos(angle) * b - std::sin(angle) * t,
      .receiver_m = std::max(smoothing_texels * texel_m, wide),
      .light_m = pcss ? std::min(frame::disc_radius_per_d_min * radius_m, 0.5f * distance) : 0.0f};
}

// How much of a map's light the point sees, as the filter will say. Cascades are so fine that their filter is left out.
float visibility(const LightSamples& samples, const MapMember& map, uint32_t point, const ShadowReading& reading) {
  const pack::Light& light = samples.light(map.center);
  if (reading.filter == Filter::hard || light.type == pack::LightType::directional)
    return samples.sees(map.center, point) ? 1.0f : 0.0f;
  const float angle = static_cast<float>(point % 64u) * (std::numbers::pi_v<float> / 32.0f);
  const Discs discs = discs_at(samples.points()[point], light.position_ws, map.filter_radius_m, reading, angle);
  const float farthest = glm::distance(samples.points()[point].position_ws, light.position_ws);
  uint32_t lit = 0;
  for (const glm::vec2& tap : poisson_disc) {
    const glm::vec3 side = tap.x * discs.u_ws + tap.y * discs.v_ws;
    // What is farther away than the receiver cannot shadow it (receiver_disc.glsl:Tap).
    const glm::vec3 d = discs.receiver_ws + discs.receiver_m * side - light.position_ws;
    const glm::vec3 place = light.position_ws + d * std::min(1.0f, farthest / glm::length(d));
    lit += samples.is_lit(map.center, place, -discs.light_m * side) ? 1 : 0;
  }
  return static_cast<float>(lit) / static_cast<float>(poisson_disc.size());
}

}  // namespace

double estimated_rmse(const LightSamples& samples, std::span<const MapMember> members, const ShadowReading& reading) {
  const auto points = samples.points();
  std::vector<glm::vec3> estimate;
  for (const auto& point : points) estimate.push_back(point.unshadowable);
  constexpr float not_asked = -1.0f;
  std::vector<float> of_map(points.size());
  for (size_t i = 0; i < members.size(); ++i) {
    const MapMember& member = members[i];
    if (i == 0 || members[i - 1].center != member.center) std::fill(of_map.begin(), of_map.end(), not_asked);
    for (const LightSamples::Reach& reach : samples.reach(member.light)) {
      float& lit = of_map[reach.point];
      if (lit == not_asked) lit = visibility(samples, member, reach.point, reading);
      estimate[reach.point] += lit * reach.radiance;
    }
  }
  double sum = 0.0;
  for (size_t p = 0; p < points.size(); ++p) {
    const glm::vec3 d = shown(estimate[p]) - shown(points[p].reference);
    sum += glm::dot(d, d);
  }
  return std::sqrt(sum / (3.0 * samples.cell_count()));
}

}  // namespace chandelier
