// SPDX-License-Identifier: Apache-2.0
// Rays through a pack's own hierarchies. Plain C++, no Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "pack_schema.h"
#include "rays/ray.h"

namespace chandelier::rays {

struct Hit {
  float distance_m;
  glm::vec3 normal_ws;  // of the triangle, unit length, out of its front
  uint32_t instance;    // numbers in the pack
  uint32_t batch;
  uint32_t material;
};

/// What a ray can hit: all visible surfaces, or only those that cast a shadow.
enum class Meets { surfaces, casters };

/// Rays against the triangles of a pack at rest; set_transform() moves instances. Alpha-masked materials are never hit,
/// since textures are not read. Several threads may call the const functions. Copies share the triangles; each has
/// instances of its own.
class PackRays {
 public:
  /// What `pack` points to must outlive it. A pack without hierarchies is searched box by box, which is slow.
  explicit PackRays(const pack::View& pack);

  /// Moves an instance: the rows of a 3×4 matrix. No other thread may use the object meanwhile. Moved instances are
  /// tested one by one, which is slow for many.
  void set_transform(uint32_t instance, const std::array<glm::vec4, 3>& world_from_local);

  /// Whether a triangle that casts a shadow lies strictly between the points. Both ends are moved inwards by
  /// end_gap_m(), so that points on surfaces do not hit their own surface.
  bool blocked(const glm::vec3& from_ws, const glm::vec3& to_ws) const;
  /// The first triangle, seen from either side, nearer than max_m along `way_ws`, which has any length but 0. A
  /// triangle that contains `from_ws` may be hit at a distance of almost 0: start off the surface.
  std::optional<Hit> first_hit(const glm::vec3& from_ws, const glm::vec3& way_ws, float max_m,
                               Meets meets = Meets::surfaces) const;

  /// 1e-4 of the distance, or the rounding error of floats this far from the origin if that is more.
  static float end_gap_m(const glm::vec3& from_ws, const glm::vec3& to_ws);

 private:
  // In the space of its mesh, where the tree's leaf has it.
  struct Triangle {
    std::array<glm::vec3, 3> corners_ls;
    uint32_t batch;
  };
  struct Met {
    uint32_t instance = pack::none;
    uint32_t batch = pack::none;
    uint32_t first_index = 0;  // of its corners
  };

  void gather_triangles();
  void gather_instances();
  bool place(uint32_t instance);
  std::array<glm::vec3, 3> corners_ws(uint32_t instance, uint32_t first_index) const;

  // Each returns true if the search may stop, since any hit is enough. Shortens the ray to its hit.
  template <bool any_is_enough>
  bool cast(const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets, Ray& ray, Met& met) const;
  template <bool any_is_enough>
  bool cast_at_instance(uint32_t instance, const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets, Ray& ray,
                        Met& met) const;
  template <bool any_is_enough>
  bool cast_at_moved(uint32_t instance, const glm::vec3& from_ws, const glm::vec3& way_ws, Meets meets, Ray& ray,
                     Met& met) const;
  template <bool any_is_enough>
  bool cast_at_batch(uint32_t instance, uint32_t number, Meets meets, Ray& ray, Met& met) const;
  bool is_met(uint32_t batch, Meets meets) const;
  bool is_passed(uint32_t instance, Meets meets) const;

  pack::View pack_;
  std::vector<pack::Instance> instances_;                   // as they stand now
  std::shared_ptr<const std::vector<Triangle>> triangles_;  // as triangle_bvh_items; one for all copies
  std::vector<glm::mat4x3> local_from_world_;               // one per instance
  std::vector<uint32_t> unsorted_instances_;                // with a tree of their own, but not in instance_bvh
  std::vector<uint32_t> loose_;                             // batch instances that are in no tree
  std::vector<bool> is_moved_;   // of each instance: set_transform() was called, so the lists above are wrong
  std::vector<uint32_t> moved_;  // those instances
};

}  // namespace chandelier::rays
