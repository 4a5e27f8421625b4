// SPDX-License-Identifier: Apache-2.0
#include "truth/ray_traced.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "parallel.h"
#include "throws_shadow.h"
#include "truth/alpha_texture.h"

namespace chandelier::truth {
namespace {

constexpr size_t points_at_once = 4096;  // of a thread
constexpr size_t rays_at_once = 8;
constexpr uint32_t rays_to_disc = 32;  // from a point to a light with a radius

// A triangle's corner for alpha tests. Each member is interpolated linearly over the triangle.
struct AlphaCorner {
  glm::vec2 uv;  // of the image
  float alpha;   // of material and vertex
};

// Triangles that are drawn with the same test.
struct Casters {
  std::vector<glm::vec3> corners;
  std::vector<AlphaCorner> alpha_corners;  // empty for opaque ones
  std::optional<AlphaTexture> texture;
  float cutoff = 0.0f;

  // Where a ray met the triangle: barycentric coordinates of its second and third corner.
  bool has_surface_at(size_t triangle, float u, float v) const {
    const AlphaCorner* const corner = &alpha_corners[3 * triangle];
    const float w = 1.0f - u - v;
    const float alpha = w * corner[0].alpha + u * corner[1].alpha + v * corner[2].alpha;
    return alpha * (texture ? texture->at(w * corner[0].uv + u * corner[1].uv + v * corner[2].uv) : 1.0f) >= cutoff;
  }
};

void let_through_cut_out(const RTCFilterFunctionNArguments* hits) {
  const auto& casters = *static_cast<const Casters*>(hits->geometryUserPtr);
  for (unsigned i = 0; i < hits->N; ++i) {
    if (hits->valid[i] == 0) continue;
    const unsigned triangle = RTCHitN_primID(hits->hit, hits->N, i);
    if (!casters.has_surface_at(triangle, RTCHitN_u(hits->hit, hits->N, i), RTCHitN_v(hits->hit, hits->N, i)))
      hits->valid[i] = 0;
  }
}

// The same arithmetic as scene/instance.glsl.
glm::vec3 position_from(const glm::vec3& origin_ws, const pack::Instance& instance, const glm::vec3& p) {
  const auto& rows = instance.world_from_local;
  return {glm::dot(glm::vec3(rows[0]), p) + (rows[0].w - origin_ws.x),
          glm::dot(glm::vec3(rows[1]), p) + (rows[1].w - origin_ws.y),
          glm::dot(glm::vec3(rows[2]), p) + (rows[2].w - origin_ws.z)};
}

// The origin of Embree's scene: near the eye, so that coordinates are rounded little. In most scenes it is the world's
// origin.
constexpr float origin_step_m = 1024.0f;

glm::vec3 origin_near(const glm::vec3& eye_ws) {
  return glm::round(eye_ws / origin_step_m) * origin_step_m;
}

// Half a step would do, but then an eye that moves back and forth there would cause a rebuild each time.
bool is_far_from(const glm::vec3& eye_ws, const glm::vec3& origin_ws) {
  return glm::any(glm::greaterThan(glm::abs(eye_ws - origin_ws), glm::vec3(0.75f * origin_step_m)));
}

// As shadows/raster/caster.glsl and shading/uv_transform.glsl.
AlphaCorner alpha_corner(const pack::View& pack, const pack::Material& material, uint32_t vertex) {
  const pack::VertexAttributes& attributes = pack.vertex_attributes[vertex];
  AlphaCorner corner{{}, material.base_color_factor.a * static_cast<float>(attributes.color >> 24) / 255.0f};
  if (material.base_color_texture == pack::none) return corner;
  const glm::vec3 uv((material.uv1_mask & 1u) != 0u ? attributes.uv1 : attributes.uv0, 1.0f);
  const auto& rows = pack.textures[material.base_color_texture].uv_transform;
  corner.uv = {glm::dot(rows[0], uv), glm::dot(rows[1], uv)};
  return corner;
}

// Triangles by material, those without an alpha test together; relative to `origin_ws`.
std::map<uint32_t, Casters> gather_casters(const World& world, const glm::vec3& origin_ws) {
  const pack::View& pack = world.pack();
  std::map<uint32_t, Casters> by_test;
  for (const pack::BatchInstance& placed : world.batch_instances()) {
    if (!pack::throws_shadow(pack, placed)) continue;
    const pack::Batch& batch = pack.batches[placed.batch];
    const pack::Material& material = pack.materials[batch.material];
    const bool masked = material.alpha_mode == pack::AlphaMode::mask;
    Casters& casters = by_test[masked ? batch.material : pack::none];
    for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; ++i) {
      const uint32_t vertex = pack.indices[i].vertex;
      casters.corners.push_back(
          position_from(origin_ws, world.instances()[placed.instance], pack.positions[vertex].position_ls));
      if (masked) casters.alpha_corners.push_back(alpha_corner(pack, material, vertex));
    }
    if (!masked || casters.texture) continue;
    casters.cutoff = material.alpha_cutoff;
    if (material.base_color_texture != pack::none)
      casters.texture.emplace(pack, pack.textures[material.base_color_texture]);
  }
  return by_test;
}

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

class RayScene {
 public:
  RayScene(const World& world, const glm::vec3& origin_ws);

  /// Whether the scene is still valid for this eye.
  bool serves(const World& world, const glm::vec3& eye_ws) const {
    return instances_ == world.instances_version() && !is_far_from(eye_ws, origin_ws_);
  }
  void answer(const VisibilityQuery& query) const;

 private:
  void add(Casters& casters);
  void check(const std::string& what) const;
  void answer_part(const VisibilityQuery& query, size_t first, size_t end) const;

  Version instances_;                    // of the world, when this was built
  glm::vec3 origin_ws_;                  // origin of all coordinates here
  std::map<uint32_t, Casters> casters_;  // outlive the scene, which reads their corners
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
};

RayScene::RayScene(const World& world, const glm::vec3& origin_ws)
    : instances_(world.instances_version()),
      origin_ws_(origin_ws),
      casters_(gather_casters(world, origin_ws)),
      device_(rtcNewDevice(nullptr)) {
  if (!device_)
    throw std::runtime_error("Embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);  // nothing slips through where triangles meet
  for (auto& [test, casters] : casters_) add(casters);
  rtcCommitScene(scene_.get());
  check("the scene");
}

void RayScene::check(const std::string& what) const {
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree: cannot build " + what + " (error " + std::to_string(error) + ")");
}

void RayScene::add(Casters& casters) {
  const size_t corners = casters.corners.size();
  casters.corners.emplace_back();  // Embree reads four floats at a corner
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, casters.corners.data(), 0,
                             sizeof(glm::vec3), corners);
  auto* const indices = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), corners / 3));
  check(std::to_string(corners / 3) + " triangles");
  std::iota(indices, indices + corners, 0u);
  if (!casters.alpha_corners.empty()) {
    rtcSetGeometryUserData(geometry, &casters);
    rtcSetGeometryOccludedFilterFunction(geometry, let_through_cut_out);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
}

// A point that the camera sees, from the scene's origin.
struct Seen {
  glm::vec3 position;
  glm::vec3 normal_ws;
  float gap_m;
};

// How far a point may lie behind its surface: it is computed in floats from a 32-bit depth (README.md).
Seen seen_from(const glm::vec3& eye, const SurfacePoint& point) {
  const glm::vec3 position = eye + point.position, p = glm::abs(position);
  const float distance = glm::length(point.position);
  const float of_depth = 1e-5f * std::max(5.0f * std::min(1.0f, distance), distance);
  return {position, point.normal_ws, std::max(of_depth, 1e-6f * std::max(p.x, std::max(p.y, p.z)))};
}

// A ray: from + t · way, t from `begin` to `end`. The light is visible if nothing blocks it.
struct Sight {
  glm::vec3 from;
  glm::vec3 way;
  float begin;
  float end;
};

// The ray to the light's centre. Empty if none is needed: the light does not reach the point, or shines on its back.
// `light_position` is relative to the scene's origin, like the point.
std::optional<Sight> sight(const frame::FrameLight& light, const glm::vec3& light_position, float near_m,
                           const Seen& point) {
  // The same gap again along the ray: at the seam of two walls, a point of one may lie behind the other.
  const float gap = point.gap_m;
  const glm::vec3 from = point.position + gap * point.normal_ws;
  if (light.type == static_cast<uint32_t>(pack::LightType::directional)) {
    if (!(glm::dot(point.normal_ws, light.direction_ws) < 0.0f)) return std::nullopt;
    return Sight{from, -light.direction_ws, gap, INFINITY};
  }
  const glm::vec3 to_light = light_position - point.position;
  const float distance_m = glm::length(to_light);
  if (!(glm::dot(point.normal_ws, to_light) > 0.0f) || !(distance_m < light.range_m)) return std::nullopt;
  if (!(glm::dot(light.direction_ws, -to_light) * light.cone_scale + light.cone_offset * distance_m > 0.0f))
    return std::nullopt;
  const glm::vec3 way = light_position - from;
  const float length = glm::length(way);
  return Sight{from, way, gap / length, std::max(0.0f, 1.0f - near_m / length)};
}

// Points of a disc, evenly (Vogel 1979), turned by `turn` radians.
glm::vec2 disc_point(uint32_t i, uint32_t count, float turn) {
  constexpr float golden_angle = 2.3999632f;
  const float angle = turn + golden_angle * static_cast<float>(i);
  const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

// A point sees a sphere as a disc perpendicular to the ray to its centre. Each point uses other places of the disc.
class Disc {
 public:
  Disc(const Sight& to_middle, float radius_m, size_t point) : to_middle_(to_middle) {
    const glm::vec3 way = glm::normalize(to_middle.way);
    across_ =
        radius_m * glm::normalize(glm::cross(way, std::abs(way.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    up_ = glm::cross(way, across_);
    turn_ = 6.2831853f * glm::fract(0.61803399f * static_cast<float>(point % 65536));
  }

  Sight sight(uint32_t i) const {
    const glm::vec2 at = disc_point(i, rays_to_disc, turn_);
    Sight to_place = to_middle_;
    to_place.way += at.x * across_ + at.y * up_;
    return to_place;
  }

 private:
  Sight to_middle_;
  glm::vec3 across_, up_;
  float turn_;
};

// Rays that are traced together.
struct Bundle {
  alignas(32) std::array<int, rays_at_once> valid{};
  RTCRay8 rays{};
  std::array<size_t, rays_at_once> point{};
  size_t count = 0;

  void add(const Sight& way, size_t number, RTCScene scene, std::span<uint8_t> lit) {
    if (count == rays_at_once) trace(scene, lit);
    const size_t i = count++;
    valid[i] = -1;
    point[i] = number;
    rays.org_x[i] = way.from.x, rays.org_y[i] = way.from.y, rays.org_z[i] = way.from.z;
    rays.dir_x[i] = way.way.x, rays.dir_y[i] = way.way.y, rays.dir_z[i] = way.way.z;
    rays.tnear[i] = way.begin, rays.tfar[i] = way.end;
    rays.time[i] = 0.0f, rays.mask[i] = ~0u, rays.id[i] = 0, rays.flags[i] = 0;
  }

  // Counts clear rays, and empties the bundle.
  void trace(RTCScene scene, std::span<uint8_t> lit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded8(valid.data(), scene, &context, &rays);
    for (size_t i = 0; i < count; ++i)
      if (rays.tfar[i] >= 0.0f) ++lit[point[i]];
    valid.fill(0);
    count = 0;
  }
};

void RayScene::answer_part(const VisibilityQuery& query, size_t first, size_t end) const {
  const uint32_t rays = query.radius_m > 0.0f ? rays_to_disc : 1;
  const glm::vec3 eye = query.eye_ws - origin_ws_, light = query.light.position_ws - origin_ws_;
  const auto lit = query.visibility;  // holds the number of clear rays per point first
  Bundle bundle;
  for (size_t i = first; i < end; ++i) {
    lit[i] = 0;
    const auto to_middle = sight(query.light, light, query.near_m, seen_from(eye, query.points[i]));
    if (!to_middle) continue;
    if (rays == 1) {
      bundle.add(*to_middle, i, scene_.get(), lit);
      continue;
    }
    const Disc disc(*to_middle, query.radius_m, i);
    for (uint32_t ray = 0; ray < rays; ++ray) bundle.add(disc.sight(ray), i, scene_.get(), lit);
  }
  bundle.trace(scene_.get(), lit);
  for (size_t i = first; i < end; ++i) lit[i] = static_cast<uint8_t>((lit[i] * 255 + rays / 2) / rays);
}

void RayScene::answer(const VisibilityQuery& query) const {
  const size_t parts = (query.points.size() + points_at_once - 1) / points_at_once;
  pack::parallel_for(parts, 0, [&](size_t part) {
    answer_part(query, part * points_at_once, std::min(query.points.size(), (part + 1) * points_at_once));
  });
}

}  // namespace

VisibilitySource ray_traced_visibility(const World& world) {
  const auto scene = std::make_shared<std::unique_ptr<const RayScene>>();
  return [&world, scene](const VisibilityQuery& query) {
    if (*scene && !(*scene)->serves(world, query.eye_ws)) scene->reset();  // before another takes memory
    if (!*scene) *scene = std::make_unique<const RayScene>(world, origin_near(query.eye_ws));
    (*scene)->answer(query);
  };
}

}  // namespace chandelier::truth
