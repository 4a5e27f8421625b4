// SPDX-License-Identifier: Apache-2.0
#include "shadows/deliver/visibility_textures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chandelier {
namespace {

struct Span {
  float low;
  float high;
};

// Tangents of the angles, from straight ahead, between which a circle is seen. `across` and `ahead` are its centre's.
Span seen_tangents(float across, float ahead, float radius_m) {
  constexpr float quarter_turn = std::numbers::pi_v<float> / 2.0f;
  const float distance_m = std::hypot(across, ahead);
  if (distance_m <= radius_m) return {-INFINITY, INFINITY};
  const float middle = std::atan2(across, ahead);
  const float half = std::asin(radius_m / distance_m);
  // What lies beyond a quarter turn is behind the camera.
  const auto tangent = [](float angle) {
    return std::abs(angle) < quarter_turn ? std::tan(angle) : std::copysign(INFINITY, angle);
  };
  return {tangent(middle - half), tangent(middle + half)};
}

// First pixel and number of pixels between two tangents; `edge` is the tangent at the picture's edge. A pixel's margin
// on either side takes up rounding.
std::pair<uint32_t, uint32_t> pixels_between(const Span& tangents, float edge, uint32_t size) {
  const auto pixel = [&](float tangent) {
    return std::clamp((tangent / edge * 0.5f + 0.5f) * static_cast<float>(size), -1.0f,
                      static_cast<float>(size) + 1.0f);
  };
  const float low = std::clamp(std::floor(pixel(tangents.low)) - 1.0f, 0.0f, static_cast<float>(size));
  const float high = std::clamp(std::ceil(pixel(tangents.high)) + 1.0f, low, static_cast<float>(size));
  return {static_cast<uint32_t>(low), static_cast<uint32_t>(high - low)};
}

}  // namespace

PixelRect sphere_rect(const Camera& camera, uint32_t width, uint32_t height, const glm::vec3& center_ws,
                      float radius_m) {
  const CameraAxes axes = axes_of(camera);
  const glm::vec3 d = center_ws - camera.eye_ws;
  const float ahead = glm::dot(d, axes.forward);
  const float edge_y = std::tan(camera.yfov_rad * 0.5f);
  const float edge_x = edge_y * static_cast<float>(width) / static_cast<float>(height);
  const auto [x, columns] = pixels_between(seen_tangents(glm::dot(d, axes.right), ahead, radius_m), edge_x, width);
  const auto [y, rows] = pixels_between(seen_tangents(-glm::dot(d, axes.up), ahead, radius_m), edge_y, height);
  if (columns == 0 || rows == 0) return {};
  return {x, y, columns, rows};
}

void place_visibility_rects(LightList& list, const Camera& camera, uint32_t width, uint32_t height) {
  for (frame::ShadowMap& map : list.maps) {
    const PixelRect rect = map.projection == frame::Projection::cascade
                               ? PixelRect{0, 0, width, height}
                               : sphere_rect(camera, width, height, map.center_ws, map.range_m);
    map.rect_x = rect.x;
    map.rect_y = rect.y;
    map.rect_width = rect.width;
    map.rect_height = rect.height;
  }
}

}  // namespace chandelier
