// SPDX-License-Identifier: Apache-2.0
// Cube faces follow Vulkan's table of cube map axes, so that a face drawn here is what a cube sampler reads.
#include "shadows/project/shadow_views.h"

#include <algorithm>
#include <cmath>

namespace chandelier {
namespace {

std::array<glm::vec4, 4> columns(const glm::vec4& x, const glm::vec4& y, const glm::vec4& z, const glm::vec4& w) {
  const glm::mat4 m = glm::transpose(glm::mat4(x, y, z, w));
  return {m[0], m[1], m[2], m[3]};
}

// Depth is near / distance along the major axis: it does not depend on the light's range, so lights that share a map
// read the same values as if each had its own.
frame::ShadowView cube_view(const frame::ShadowMap& map, uint32_t face, float texel_m) {
  const CubeFace axes = cube_face(face);
  return {.clip_from_center = columns(glm::vec4(axes.s, 0), glm::vec4(axes.t, 0), glm::vec4(0, 0, 0, map.near_m),
                                      glm::vec4(axes.major, 0)),
          .center_ws = map.center_ws,
          .range_m = map.range_m,
          .projection = frame::Projection::cube_face,
          .layer = face,
          .size_px = map.size_px,
          .texel_m = texel_m,
          .far_m = 0.0f};
}

// How far beyond a receiver a filter reads, per metre from the map's centre: a few texels, and as much of the area
// light as a receiver sees a quarter of the range away; half as much again, where pixels share what they read.
float filter_reach(const frame::ShadowMap& map, float range_m, float texel_m) {
  return 6.0f * texel_m + 1.5f * std::min(0.5f, map.filter_radius_m / (0.25f * std::max(range_m, 1e-6f)));
}

// Is anything that the spot light reaches on the pyramid of a face, seen from the map's centre? What it reaches is a
// sector of a ball around itself. Conservative: it says no where all of the sector is beyond one side of the pyramid.
// Along a side's normal n, seen from the centre, a receiver t metres from the light is at most
// n.offset + t cos(angle between n and the cone) far: linear in t, so the largest is at either end.
bool reaches_face(const CubeFace& face, const frame::ShadowMap& map, const frame::FrameLight& light, float texel_m) {
  const float cone_rad = std::acos(std::clamp(-light.cone_offset / light.cone_scale, -1.0f, 1.0f));
  const glm::vec3 offset = light.position_ws - map.center_ws;
  const float margin = filter_reach(map, light.range_m, texel_m);
  for (const glm::vec3& side : {face.s, -face.s, face.t, -face.t}) {
    const glm::vec3 normal = (face.major + side) / std::sqrt(2.0f);
    const float to_axis = std::acos(std::clamp(glm::dot(light.direction_ws, normal), -1.0f, 1.0f));
    const float per_metre = std::cos(std::max(0.0f, to_axis - cone_rad)) + margin;
    const float nearest = glm::dot(normal, offset) + margin * glm::length(offset);
    if (nearest <= 0.0f && nearest + light.range_m * per_metre < 0.0f) return false;
  }
  return true;
}

void project_cube(const LightList& list, const frame::ShadowMap& map, std::vector<frame::ShadowView>& views) {
  const float texel_m = 2.0f / static_cast<float>(map.size_px);  // a face is two metres wide at one metre
  const std::span members(list.lights.begin() + map.first_light, map.light_count);
  for (uint32_t face = 0; face < 6; ++face) {
    const bool needed = std::any_of(members.begin(), members.end(), [&](const frame::FrameLight& light) {
      return light.type != static_cast<uint32_t>(pack::LightType::spot) ||
             reaches_face(cube_face(face), map, light, texel_m);
    });
    if (needed) views.push_back(cube_view(map, face, texel_m));
  }
}

std::array<glm::vec3, 8> corners(const Bounds& b) {
  std::array<glm::vec3, 8> c;
  for (uint32_t i = 0; i < 8; ++i)
    c[i] = {i & 1 ? b.max_ws.x : b.min_ws.x, i & 2 ? b.max_ws.y : b.min_ws.y, i & 4 ? b.max_ws.z : b.min_ws.z};
  return c;
}

// Logarithmic splits (Zhang et al. 2006, parallel-split shadow maps), metres along the view: texels look equally large
// in every cascade. What is nearer than 1/50 of the farthest thing in the scene, or than 5 m, shares the first one.
std::array<float, frame::cascade_count + 1> split_depths(const Camera& camera, const Bounds& bounds) {
  float far_m = camera.znear_m * 2.0f;
  for (const glm::vec3& corner : corners(bounds))
    far_m = std::max(far_m, glm::dot(corner - camera.eye_ws, camera.forward_ws));
  const float near_m = std::max(camera.znear_m, std::min(far_m * 0.02f, 5.0f));
  std::array<float, frame::cascade_count + 1> splits{};
  for (uint32_t i = 1; i <= frame::cascade_count; ++i)
    splits[i] = near_m * std::pow(far_m / near_m, static_cast<float>(i) / frame::cascade_count);
  return splits;
}

struct Sphere {
  glm::vec3 center;  // from the eye
  float radius_m;
};

// Around the piece of the view frustum between two depths; the same size whichever way the camera looks.
Sphere slice_sphere(const Camera& camera, float aspect, float near_m, float far_m) {
  const float y = std::tan(camera.yfov_rad * 0.5f);
  const float corner2 = y * y * (1.0f + aspect * aspect);  // squared half diagonal at one metre
  const float middle = std::min(far_m, 0.5f * (near_m + far_m) * (1.0f + corner2));
  const float radius = std::sqrt(corner2 * far_m * far_m + (far_m - middle) * (far_m - middle));
  return {glm::normalize(camera.forward_ws) * middle, radius};
}

frame::ShadowView cascade_view(const Sphere& sphere, const glm::vec3& eye_ws, const glm::vec3& direction,
                               const Bounds& bounds, uint32_t cascade, float far_m, uint32_t size_px) {
  const CameraAxes axes = axes_of({.forward_ws = direction});
  // Six texels of margin on each side, for snapping, normal offset and filter.
  const float texels = static_cast<float>(std::max(size_px, 16u) - 12u);
  const float texel_m = 2.0f * sphere.radius_m / texels;
  // To texels of the world, so that edges stand still when the camera moves; then seen from the eye.
  const auto snapped = [&](const glm::vec3& axis) {
    const double eye_m = glm::dot(glm::dvec3(axis), glm::dvec3(eye_ws));
    const double center_m = eye_m + glm::dot(glm::dvec3(axis), glm::dvec3(sphere.center));
    return static_cast<float>(std::floor(center_m / texel_m) * texel_m - eye_m);
  };
  float nearest = INFINITY;  // along the light's way, over the whole scene: casters may stand outside the view
  float farthest = -INFINITY;
  for (const glm::vec3& corner : corners(bounds)) {
    nearest = std::min(nearest, glm::dot(corner - eye_ws, axes.forward));
    farthest = std::max(farthest, glm::dot(corner - eye_ws, axes.forward));
  }
  const float margin = 0.01f + 0.001f * (farthest - nearest);
  nearest -= margin;
  farthest += margin;
  const float scale = 2.0f / (texel_m * static_cast<float>(size_px));
  const float depth_scale = 1.0f / (farthest - nearest);
  return {.clip_from_center =
              columns(glm::vec4(axes.right * scale, -snapped(axes.right) * scale),
                      glm::vec4(-axes.up * scale, snapped(axes.up) * scale),
                      glm::vec4(-axes.forward * depth_scale, farthest * depth_scale), glm::vec4(0, 0, 0, 1)),
          .center_ws = eye_ws,
          .range_m = 0.0f,
          .projection = frame::Projection::cascade,
          .layer = cascade,
          .size_px = size_px,
          .texel_m = texel_m,
          .far_m = far_m};
}

void project_cascades(const LightList& list, uint32_t map_number, const Camera& camera, float aspect,
                      const Bounds& bounds, std::vector<frame::ShadowView>& views) {
  const glm::vec3 direction = list.map_direction_ws[map_number];
  const auto splits = split_depths(camera, bounds);
  for (uint32_t i = 0; i < frame::cascade_count; ++i)
    views.push_back(cascade_view(slice_sphere(camera, aspect, splits[i], splits[i + 1]), camera.eye_ws, direction,
                                 bounds, i, splits[i + 1], list.maps[map_number].size_px));
}

}  // namespace

CubeFace cube_face(uint32_t face) {
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  switch (face) {
    case 0:
      return {-z, -y, x};
    case 1:
      return {z, -y, -x};
    case 2:
      return {x, z, y};
    case 3:
      return {x, -z, -y};
    case 4:
      return {x, -y, z};
    default:
      return {-x, -y, -z};
  }
}

std::vector<frame::ShadowView> project_lights(LightList& list, const Camera& camera, float aspect,
                                              const Bounds& bounds) {
  std::vector<frame::ShadowView> views;
  for (uint32_t i = 0; i < list.maps.size(); ++i) {
    frame::ShadowMap& map = list.maps[i];
    map.first_view = static_cast<uint32_t>(views.size());
    switch (map.projection) {
      case frame::Projection::cube_face:
        project_cube(list, map, views);
        break;
      case frame::Projection::cascade:
        project_cascades(list, i, camera, aspect, bounds, views);
        break;
    }
    map.view_count = static_cast<uint32_t>(views.size()) - map.first_view;
  }
  return views;
}

}  // namespace chandelier
