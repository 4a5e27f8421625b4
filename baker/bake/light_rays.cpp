// SPDX-License-Identifier: Apache-2.0
// Traverses batch_bvh if the pack has one, else all batch instances, then the triangles of the batches that are hit.
#include "light_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "is_static.h"
#include "throws_shadow.h"
#include "triangle_distance.h"

namespace chandelier::baker {
namespace {

/// Calls visit(batch instance) for the static ones whose box `meets(low, high)`, until it returns true. Returns whether
/// it did.
template <typename Meets, typename Visit>
bool visit_batches(const pack::Contents& pack, Meets meets, Visit visit) {
  const auto test = [&](const pack::BatchInstance& draw) {
    return meets(draw.bounds_min_ws, draw.bounds_max_ws) && visit(draw);
  };
  if (pack.batch_bvh.empty()) {
    return std::any_of(pack.batch_instances.begin(), pack.batch_instances.end(), [&](const pack::BatchInstance& draw) {
      return pack.instances[draw.instance].dynamic == 0 && test(draw);
    });
  }
  for (size_t i = 0; i < pack.batch_bvh.size();) {
    const pack::BvhNode& node = pack.batch_bvh[i];
    if (!meets(node.bounds_min, node.bounds_max)) {
      i = node.skip;
      continue;
    }
    const uint32_t first = node.leaf / 16, count = node.leaf == pack::none ? 0 : node.leaf % 16;
    for (uint32_t item = first; item < first + count; ++item) {
      if (test(pack.batch_instances[pack.batch_bvh_items[item].batch_instance])) return true;
    }
    ++i;
  }
  return false;
}

using pack::distance_to_triangle;
using pack::Triangle;

Triangle triangle_ls(const pack::Contents& pack, uint32_t first_index) {
  Triangle out;
  for (uint32_t i = 0; i < 3; ++i) {
    out[i] = glm::dvec3(pack.positions[pack.indices[first_index + i].vertex].position_ls);
  }
  return out;
}

glm::dmat4 world_from_local(const pack::Instance& instance) {
  glm::dmat4 out(1);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out[column][row] = instance.world_from_local[row][column];
  }
  return out;
}

struct Ray {
  glm::dvec3 from, way;
};

bool meets_box(const Ray& ray, const glm::vec3& low, const glm::vec3& high) {
  double enter = 0, leave = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (low[axis] - ray.from[axis]) / ray.way[axis], b = (high[axis] - ray.from[axis]) / ray.way[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave * (1 + 1e-12);
}

/// Moeller and Trumbore 1997. The distance, or infinity; `leaves`: the ray goes from back to front.
double intersect_triangle(const Ray& ray, const Triangle& triangle, bool& leaves) {
  const glm::dvec3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0], a = ray.from - triangle[0];
  const glm::dvec3 across = glm::cross(ray.way, ac);
  const double volume = glm::dot(ab, across);
  if (volume == 0) return INFINITY;
  const double u = glm::dot(a, across) / volume;
  const glm::dvec3 other = glm::cross(a, ab);
  const double v = glm::dot(ray.way, other) / volume;
  const double distance = glm::dot(ac, other) / volume;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && distance > 0)) return INFINITY;
  leaves = volume < 0;
  return distance;
}

/// Whether a point of the box is within `radius` of `point`.
bool is_near_box(const glm::dvec3& point, double radius, const glm::vec3& low, const glm::vec3& high) {
  const glm::dvec3 apart = point - glm::clamp(point, glm::dvec3(low), glm::dvec3(high));
  return glm::dot(apart, apart) <= radius * radius;
}

/// The largest cosine between `axis` and a point of the segment a, b, both seen from the origin. Along the segment it
/// is (a + t d)·axis / |a + t d|, with one extremum, where the derivative is zero.
double cosine_to_segment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& axis) {
  const glm::dvec3 d = b - a;
  const double ad = glm::dot(a, d), below = glm::dot(d, axis) * ad - glm::dot(a, axis) * glm::dot(d, d);
  const double t = (glm::dot(a, axis) * ad - glm::dot(d, axis) * glm::dot(a, a)) / below;
  double most = -1;
  for (const double at : {0.0, 1.0, std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : 0.0}) {
    const glm::dvec3 p = a + d * at;
    const double length = glm::length(p);
    if (length == 0) return 1;
    most = std::max(most, glm::dot(p, axis) / length);
  }
  return most;
}

double cosine_to_triangle(const Triangle& t, const glm::dvec3& axis) {
  bool leaves = false;
  if (std::isfinite(intersect_triangle({glm::dvec3(0), axis}, t, leaves))) return 1;
  return std::max(
      {cosine_to_segment(t[0], t[1], axis), cosine_to_segment(t[1], t[2], axis), cosine_to_segment(t[2], t[0], axis)});
}

/// Adds the ray's hits with those triangles of the batch that cast shadows. The ray is transformed to mesh space
/// without scaling its direction, so that distances along it stay the same.
void cast_at_batch(const pack::Contents& pack, const pack::BatchInstance& draw, const Ray& ray, double least_m,
                   RayHit& hit) {
  const pack::Batch& batch = pack.batches[draw.batch];
  const pack::Material& material = pack.materials[batch.material];
  if (material.alpha_mode == pack::AlphaMode::mask || !pack::throws_shadow(pack, draw)) return;
  const glm::dmat4 world = world_from_local(pack.instances[draw.instance]), local = glm::inverse(world);
  const Ray ray_ls = {glm::dvec3(local * glm::dvec4(ray.from, 1)), glm::dvec3(local * glm::dvec4(ray.way, 0))};
  const bool mirrored = glm::determinant(glm::dmat3(world)) < 0;
  for (uint32_t i = 0; i < batch.index_count; i += 3) {
    bool leaves_ls = false;
    const double distance = intersect_triangle(ray_ls, triangle_ls(pack, batch.first_index + i), leaves_ls);
    if (!std::isfinite(distance)) continue;
    const bool leaves = leaves_ls != mirrored;
    if (batch.closed) hit.shells_around += leaves ? 1 : -1;
    if (distance < least_m || distance >= hit.distance_m) continue;
    hit.distance_m = distance;
    hit.closed_back = batch.closed && leaves;
    hit.double_sided = material.double_sided;
  }
}

}  // namespace

RayHit cast_ray(const pack::Contents& pack, const glm::dvec3& from, const glm::dvec3& way, double least_m) {
  const Ray ray = {from, way};
  RayHit hit;
  const auto meets = [&](const glm::vec3& low, const glm::vec3& high) { return meets_box(ray, low, high); };
  visit_batches(pack, meets, [&](const pack::BatchInstance& draw) {
    cast_at_batch(pack, draw, ray, least_m, hit);
    return false;
  });
  return hit;
}

std::vector<glm::dvec3> directions_of(const pack::Light& light, int count) {
  constexpr double golden_angle = 2.399963229728653;  // a Fibonacci spiral
  const double narrowest = light.type == pack::LightType::spot ? light.outer_cone_cos : -1;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction_ws));
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 other = glm::cross(axis, side);
  std::vector<glm::dvec3> out;
  for (int i = 0; i < count; ++i) {
    const double cosine = 1 - (1 - narrowest) * (i + 0.5) / count, turn = golden_angle * (i + 1);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    out.push_back(axis * cosine + (side * std::cos(turn) + other * std::sin(turn)) * sine);
  }
  return out;
}

namespace {

/// The distance from the point to the farthest corner of the box: no triangle in it is farther away.
double farthest_of_box(const glm::dvec3& point, const glm::vec3& low, const glm::vec3& high) {
  return glm::length(glm::max(glm::abs(point - glm::dvec3(low)), glm::abs(point - glm::dvec3(high))));
}

/// Calls visit(batch instance) for those that cast a shadow, moving ones at rest, and whose boxes are not farther away
/// than `nearest`, which `visit` may reduce.
template <typename Visit>
void visit_casters_near(const pack::Contents& pack, const std::vector<uint32_t>& moving, const glm::dvec3& point,
                        const double& nearest, Visit visit) {
  const auto meets = [&](const glm::vec3& low, const glm::vec3& high) {
    return is_near_box(point, nearest, low, high);
  };
  const auto visit_caster = [&](const pack::BatchInstance& draw) {
    if (pack::throws_shadow(pack, draw)) visit(draw);
    return false;
  };
  visit_batches(pack, meets, visit_caster);
  for (const uint32_t number : moving) {
    const pack::BatchInstance& draw = pack.batch_instances[number];
    if (meets(draw.bounds_min_ws, draw.bounds_max_ws)) visit_caster(draw);
  }
}

}  // namespace

std::vector<uint32_t> moving_batch_instances(const pack::Contents& pack) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < pack.batch_instances.size(); ++i) {
    if (!is_static(pack, pack.batch_instances[i])) out.push_back(i);
  }
  return out;
}

double nearest_caster_m(const pack::Contents& pack, const std::vector<uint32_t>& moving, const glm::dvec3& at,
                        double most_m) {
  double nearest = most_m;
  visit_casters_near(pack, moving, at, nearest,
                     [&](const pack::BatchInstance& draw) {  // so that few triangles are tested
                       nearest = std::min(nearest, farthest_of_box(at, draw.bounds_min_ws, draw.bounds_max_ws));
                     });
  visit_casters_near(pack, moving, at, nearest, [&](const pack::BatchInstance& draw) {
    const pack::Batch& batch = pack.batches[draw.batch];
    const glm::dmat4 world = world_from_local(pack.instances[draw.instance]);
    for (uint32_t i = 0; i < batch.index_count; i += 3) {
      Triangle triangle = triangle_ls(pack, batch.first_index + i);
      for (glm::dvec3& corner : triangle) corner = glm::dvec3(world * glm::dvec4(corner, 1)) - at;
      nearest = std::min(nearest, distance_to_triangle(triangle));
    }
  });
  return nearest;
}

bool reaches_anything(const pack::Contents& pack, const pack::Light& light) {
  const glm::dvec3 at(light.position_ws), middle(light.bounds_center_ws), axis(light.direction_ws);
  const double range = light.range_m, cosine = light.type == pack::LightType::spot ? light.outer_cone_cos : -1;
  const auto meets = [&](const glm::vec3& low, const glm::vec3& high) {
    return is_near_box(at, range, low, high) && is_near_box(middle, light.bounds_radius_m, low, high);
  };
  const auto visit = [&](const pack::BatchInstance& draw) {
    const pack::Batch& batch = pack.batches[draw.batch];
    const glm::dmat4 world = world_from_local(pack.instances[draw.instance]);
    for (uint32_t i = 0; i < batch.index_count; i += 3) {
      Triangle triangle = triangle_ls(pack, batch.first_index + i);
      for (glm::dvec3& corner : triangle) corner = glm::dvec3(world * glm::dvec4(corner, 1)) - at;
      if (distance_to_triangle(triangle) <= range && cosine_to_triangle(triangle, axis) >= cosine) return true;
    }
    return false;
  };
  if (visit_batches(pack, meets, visit)) return true;
  return std::any_of(pack.batch_instances.begin(), pack.batch_instances.end(), [&](const pack::BatchInstance& draw) {
    return pack.instances[draw.instance].dynamic == 1 && meets(draw.bounds_min_ws, draw.bounds_max_ws);
  });
}

}  // namespace chandelier::baker
