// SPDX-License-Identifier: Apache-2.0
#include "lights/error_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "frame_schema.h"
#include "lights/search_stopped.h"
#include "lights/shown_curve.h"

namespace chandelier {
namespace {

// The point itself and seven darts in the unit disc: as few as a pixel reads, whose own lie elsewhere.
constexpr std::array<glm::vec2, frame::disc_taps> poisson_disc{{{0.000f, 0.000f},
                                                                {-0.092f, -0.905f},
                                                                {-0.698f, 0.252f},
                                                                {0.719f, -0.070f},
                                                                {0.477f, 0.683f},
                                                                {-0.434f, -0.369f},
                                                                {0.301f, -0.520f},
                                                                {-0.165f, 0.666f}}};
// Numbers of shadows/filter/receiver_disc.glsl and filter_pcf.glsl.
constexpr float smoothing_texels = 1.5f;
constexpr float penumbra_per_radius = 0.27f;
constexpr float raise_texels = 0.75f;  // more than the reference is raised: the rays need none for their own sake

float largest(const glm::vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// A receiver's plane and a light (receiver_disc.glsl:CubeDisc).
struct Receiver {
  glm::vec3 center_ws;  // the light
  glm::vec3 place_ws;   // off its surface
  glm::vec3 u_ws, v_ws;
  float distance_m;
  float texel_m;
};

Receiver receiver_at(const LightSamples& samples, uint32_t center, uint32_t point, uint32_t face_size_px) {
  const glm::vec3 n = samples.points()[point].normal_ws;
  const glm::vec3 center_ws = samples.light(center).position_ws;
  const glm::vec3 d = samples.points()[point].position_ws - center_ws;
  const float distance = std::max(glm::length(d), 1e-6f);
  const float texel_m = 2.0f / static_cast<float>(face_size_px) * largest(d);
  const float along = glm::dot(n, d) / distance;
  const glm::vec3 t = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
  const glm::vec3 b = glm::cross(n, t);
  const float angle = static_cast<float>(point % 64u) * (std::numbers::pi_v<float> / 32.0f);
  return {.center_ws = center_ws,
          .place_ws = center_ws + d + n * (raise_texels * texel_m * std::sqrt(std::max(0.0f, 1.0f - along * along))),
          .u_ws = std::cos(angle) * t + std::sin(angle) * b,
          .v_ws = std::cos(angle) * b - std::sin(angle) * t,
          .distance_m = distance,
          .texel_m = texel_m};
}

// What is farther away than the receiver cannot shadow it (receiver_disc.glsl:Tap).
glm::vec3 tap_place(const Receiver& receiver, const glm::vec2& at_m) {
  const glm::vec3 d = receiver.place_ws + at_m.x * receiver.u_ws + at_m.y * receiver.v_ws - receiver.center_ws;
  return receiver.center_ws + d * std::min(1.0f, receiver.distance_m / glm::length(d));
}

// disc_taps.glsl:lit_by_taps
float pcf(const LightSamples& samples, uint32_t center, const Receiver& receiver, float radius_m) {
  uint32_t lit = 0;
  for (const glm::vec2& tap : poisson_disc) lit += samples.is_lit(center, tap_place(receiver, radius_m * tap)) ? 1 : 0;
  return static_cast<float>(lit) / frame::disc_taps;
}

// filter_pcss.glsl:cube_pcss
float pcss(const LightSamples& samples, uint32_t center, const Receiver& receiver, float light_m) {
  const float smoothing_m = smoothing_texels * receiver.texel_m;
  const float search_m = std::max(smoothing_m, std::min(light_m, 0.5f * receiver.distance_m));
  uint32_t count = 0;
  float sum = 0.0f;
  for (const glm::vec2& tap : poisson_disc) {
    const float at = samples.blocked_at(center, tap_place(receiver, search_m * tap));
    if (at == 1.0f) continue;
    ++count;
    sum += at;
  }
  if (count == 0 || count == frame::disc_taps) return count == 0 ? 1.0f : 0.0f;
  const float mean = sum / static_cast<float>(count);
  return pcf(samples, center, receiver, glm::clamp(light_m * (1.0f - mean) / mean, smoothing_m, search_m));
}

// How much of a map's light the point sees, as the filter will say. Cascades are so fine that their filter is left out.
float visibility(const LightSamples& samples, const MapMember& map, uint32_t point, const ShadowReading& reading) {
  const auto exact = [&] { return samples.sees(map.center, point) ? 1.0f : 0.0f; };
  const auto soft = [&](bool searches) {
    const Receiver receiver = receiver_at(samples, map.center, point, reading.face_size_px);
    if (searches && map.filter_radius_m > 0.0f) return pcss(samples, map.center, receiver, map.filter_radius_m);
    const float smoothing_m = smoothing_texels * receiver.texel_m;
    const float wide_m = std::min(penumbra_per_radius * map.filter_radius_m, 0.5f * receiver.distance_m);
    return pcf(samples, map.center, receiver, std::max(smoothing_m, wide_m));
  };
  if (samples.light(map.center).type == pack::LightType::directional) return exact();
  switch (reading.filter) {
    case Filter::hard:
    case Filter::rays:
      return exact();
    case Filter::pcf:
      return soft(false);
    case Filter::pcss:
      return soft(true);
  }
  refuse_answer(reading.filter);
}

}  // namespace

double estimated_rmse(const LightSamples& samples, std::span<const MapMember> members, const ShadowReading& reading,
                      const std::stop_token& stop) {
  const auto points = samples.points();
  std::vector<glm::vec3> estimate;
  for (const auto& point : points) estimate.push_back(point.unshadowable);
  constexpr float not_asked = -1.0f;
  std::vector<float> of_map(points.size());
  for (size_t i = 0; i < members.size(); ++i) {
    const MapMember& member = members[i];
    if (i == 0 || members[i - 1].center != member.center) std::fill(of_map.begin(), of_map.end(), not_asked);
    for (const LightSamples::Contribution& contribution : samples.contributions(member.light)) {
      stop_if_asked(stop);
      float& lit = of_map[contribution.point];
      if (lit == not_asked) lit = visibility(samples, member, contribution.point, reading);
      estimate[contribution.point] += member.share * lit * contribution.radiance;
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
