// SPDX-License-Identifier: Apache-2.0
// A ray walks instance_bvh in the world, then the triangle BVH of each instance that it hits, in the mesh's space.
// Nodes lie depth first and have a link for misses, so neither walk needs a stack.
#include "rays/pack_rays.h"

#include <span>
#include <utility>

namespace chandelier::rays {
namespace {

glm::dmat4 world_from_local(const pack::Instance& instance) {
  glm::dmat4 m(1.0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) m[column][row] = instance.world_from_local[row][column];
  return m;
}

// Flat within the precision of floats: the scale is 0 in some direction.
bool has_inverse(const glm::dmat4& m) {
  const double size = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  return std::abs(glm::determinant(m)) > 1e-6 * size && size > 0.0;
}

// Calls visit(item) for the items of leaves whose boxes the ray hits, until one returns true. Returns whether one did.
template <typename Visit>
bool walk(std::span<const pack::BvhNode> nodes, uint32_t first, uint32_t end, const Ray& ray, Visit visit) {
  for (uint32_t i = first; i < end;) {
    const pack::BvhNode& node = nodes[i];
    if (!ray.meets_box(node.bounds_min, node.bounds_max)) {
      i = node.skip;
      continue;
    }
    if (node.leaf != pack::none) {
      const uint32_t item = node.leaf / 16;
      for (uint32_t k = item; k < item + node.leaf % 16; ++k)
        if (visit(k)) return true;
    }
    ++i;
  }
  return false;
}

}  // namespace

PackRays::PackRays(const pack::View& pack)
    : pack_(pack), instances_(pack.instances.begin(), pack.instances.end()), is_moved_(pack.instances.size()) {
  gather_triangles();
  gather_instances();
}

void PackRays::gather_triangles() {
  std::vector<Triangle> triangles(pack_.triangle_bvh_items.size());
  std::vector<uint32_t> batch_of_triangle(triangles.empty() ? 0 : pack_.indices.size() / 3, pack::none);
  for (const pack::Mesh& mesh : pack_.meshes) {
    for (uint32_t b = mesh.first_batch; b < mesh.first_batch + mesh.batch_count && !triangles.empty(); ++b) {
      const auto first = batch_of_triangle.begin() + pack_.batches[b].first_index / 3;
      std::fill(first, first + pack_.batches[b].index_count / 3, b);
    }
    for (uint32_t n = mesh.first_node; n < mesh.first_node + mesh.node_count; ++n) {
      if (pack_.triangle_bvh[n].leaf == pack::none) continue;
      const uint32_t first = pack_.triangle_bvh[n].leaf / 16;
      for (uint32_t item = first; item < first + pack_.triangle_bvh[n].leaf % 16; ++item) {
        const uint32_t triangle = pack_.triangle_bvh_items[item].triangle;
        triangles[item].batch = batch_of_triangle[triangle];
        for (uint32_t corner = 0; corner < 3; ++corner)
          triangles[item].corners_ls[corner] = pack_.positions[pack_.indices[3 * triangle + corner].vertex].position_ls;
      }
    }
  }
  triangles_ = std::make_shared<const std::vector<Triangle>>(std::move(triangles));
}

// False if its triangles are in no tree.
bool PackRays::place(uint32_t instance) {
  const glm::dmat4 m = world_from_local(instances_[instance]);
  const bool has_tree = has_inverse(m) && pack_.meshes[instances_[instance].mesh].node_count > 0;
  local_from_world_[instance] = has_tree ? glm::mat4x3(glm::inverse(m)) : glm::mat4x3(0.0f);
  return has_tree;
}

void PackRays::set_transform(uint32_t instance, const std::array<glm::vec4, 3>& world_from_local) {
  instances_[instance].world_from_local = world_from_local;
  place(instance);
  if (is_moved_[instance]) return;
  is_moved_[instance] = true;
  moved_.push_back(instance);
}

void PackRays::gather_instances() {
  std::vector<bool> is_sorted(instances_.size());
  for (const pack::InstanceRef& item : pack_.instance_bvh_items) is_sorted[item.instance] = true;
  local_from_world_.resize(instances_.size());
  std::vector<bool> is_loose(instances_.size());
  for (uint32_t i = 0; i < instances_.size(); ++i) is_loose[i] = !place(i);
  std::vector<bool> is_listed = is_sorted;
  for (uint32_t i = 0; i < pack_.batch_instances.size(); ++i) {
    const uint32_t instance = pack_.batch_instances[i].instance;
    if (is_loose[instance]) {
      loose_.push_back(i);
    } else if (!is_listed[instance]) {
      is_listed[instance] = true;
      unsorted_instances_.push_back(instance);
    }
  }
}

bool PackRays::is_met(uint32_t batch, Meets meets) const {
  const pack::Material& material = pack_.materials[pack_.batches[batch].material];
  return material.alpha_mode != pack::AlphaMode::mask && (meets == Meets::surfaces || material.shadowless == 0);
}

bool PackRays::is_passed(uint32_t instance, Meets meets) const {
  return meets == Meets::casters && instances_[instance].shadowless != 0;
}

std::array<glm::vec3, 3> PackRays::corners_ws(uint32_t instance, uint32_t first_index) const {
  std::array<glm::vec3, 3> corners;
  const auto& rows = instances_[instance].world_from_local;
  for (uint32_t i = 0; i < 3; ++i) {
    const glm::vec4 p(pack_.positions[pack_.indices[first_index + i].vertex].position_ls, 1.0f);
    corners[i] = {glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)};
  }
  return corners;
}

// t is the same in the world and in the mesh's space, although the direction has another length there.
template <bool any_is_enough>
bool PackRays::cast_at_instance(uint32_t instance, const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets,
                                Ray& ray, Met& met) const {
  const glm::mat4x3& m = local_from_world_[instance];
  if (m == glm::mat4x3(0.0f) || is_passed(instance, meets)) return false;  // zero: loose
  Ray ray_ls(m * glm::vec4(from_ws, 1.0f), m * glm::vec4(way_ws, 0.0f), ray.nearest, ray.farthest);
  const pack::Mesh& mesh = pack_.meshes[instances_[instance].mesh];
  const uint32_t end = mesh.first_node + mesh.node_count;
  const bool stops = walk(pack_.triangle_bvh, mesh.first_node, end, ray_ls, [&](uint32_t item) {
    const Triangle& triangle = (*triangles_)[item];
    const float t = ray_ls.intersect_triangle(triangle.corners_ls);
    if (t == INFINITY || !is_met(triangle.batch, meets)) return false;
    ray_ls.farthest = t;
    met = {instance, triangle.batch, 3 * pack_.triangle_bvh_items[item].triangle};
    return any_is_enough;
  });
  ray.farthest = ray_ls.farthest;
  return stops;
}

template <bool any_is_enough>
bool PackRays::cast_at_batch(uint32_t instance, uint32_t number, Meets meets, Ray& ray, Met& met) const {
  if (is_passed(instance, meets) || !is_met(number, meets)) return false;
  const pack::Batch& batch = pack_.batches[number];
  for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
    const float t = ray.intersect_triangle(corners_ws(instance, i));
    if (t == INFINITY) continue;
    ray.farthest = t;
    met = {instance, number, i};
    if (any_is_enough) return true;
  }
  return false;
}

// Through its tree; or through all its triangles, if it has no tree or its matrix has no inverse.
template <bool any_is_enough>
bool PackRays::cast_at_moved(uint32_t instance, const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets,
                             Ray& ray, Met& met) const {
  if (local_from_world_[instance] != glm::mat4x3(0.0f))
    return cast_at_instance<any_is_enough>(instance, from_ws, way_ws, meets, ray, met);
  const pack::Mesh& mesh = pack_.meshes[instances_[instance].mesh];
  for (uint32_t batch = mesh.first_batch; batch < mesh.first_batch + mesh.batch_count; ++batch)
    if (cast_at_batch<any_is_enough>(instance, batch, meets, ray, met)) return true;
  return false;
}

template <bool any_is_enough>
bool PackRays::cast(const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets, Ray& ray, Met& met) const {
  const auto at_instance = [&](uint32_t instance) {
    return !is_moved_[instance] && cast_at_instance<any_is_enough>(instance, from_ws, way_ws, meets, ray, met);
  };
  const auto node_count = static_cast<uint32_t>(pack_.instance_bvh.size());
  if (walk(pack_.instance_bvh, 0, node_count, ray,
           [&](uint32_t item) { return at_instance(pack_.instance_bvh_items[item].instance); }))
    return true;
  for (uint32_t instance : unsorted_instances_)
    if (at_instance(instance)) return true;
  for (uint32_t number : loose_) {
    const pack::BatchInstance& draw = pack_.batch_instances[number];
    if (!is_moved_[draw.instance] && ray.meets_box(draw.bounds_min_ws, draw.bounds_max_ws) &&
        cast_at_batch<any_is_enough>(draw.instance, draw.batch, meets, ray, met))
      return true;
  }
  for (uint32_t instance : moved_)
    if (cast_at_moved<any_is_enough>(instance, from_ws, way_ws, meets, ray, met)) return true;
  return false;
}

float PackRays::end_gap_m(const glm::vec3& from_ws, const glm::vec3& to_ws) {
  const glm::vec3 farthest = glm::max(glm::abs(from_ws), glm::abs(to_ws));
  return std::max(1e-4f * glm::distance(from_ws, to_ws),
                  2e-6f * std::max(farthest.x, std::max(farthest.y, farthest.z)));
}

bool PackRays::blocked(const glm::vec3& from_ws, const glm::vec3& to_ws) const {
  const glm::vec3 way = to_ws - from_ws;
  const float gap = end_gap_m(from_ws, to_ws) / glm::length(way);
  if (!(gap < 0.5f)) return false;
  Ray ray(from_ws, way, gap, 1.0f - gap);
  Met met;
  return cast<true>(from_ws, way, Meets::casters, ray, met);
}

std::optional<Hit> PackRays::first_hit(const glm::vec3& from_ws, const glm::vec3& way_ws, float max_m,
                                       Meets meets) const {
  const float length = glm::length(way_ws);
  Ray ray(from_ws, way_ws, 0.0f, max_m / length);
  Met met;
  cast<false>(from_ws, way_ws, meets, ray, met);
  if (met.instance == pack::none) return std::nullopt;
  const auto corners = corners_ws(met.instance, met.first_index);
  // Not normalize(): a sliver's cross product may be too small to be squared.
  const glm::dvec3 across =
      glm::cross(glm::dvec3(corners[1]) - glm::dvec3(corners[0]), glm::dvec3(corners[2]) - glm::dvec3(corners[0]));
  return Hit{ray.farthest * length, glm::vec3(glm::normalize(across)), met.instance, met.batch,
             pack_.batches[met.batch].material};
}

}  // namespace chandelier::rays
