// SPDX-License-Identifier: Apache-2.0
// Finds what is around a light: rays against a pack's static triangles, and whether any triangle is within its range.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "pack_schema.h"

namespace chandelier::baker {

/// The nearest hit of a ray. Triangles that cast no shadow do not count, nor do masked materials, since textures are
/// not read here.
struct RayHit {
  double distance_m = INFINITY;  // of the first triangle
  bool closed_back = false;      // it is the back of a closed shell
  bool double_sided = false;     // its material shows its back
  int shells_around = 0;  // closed shells that the ray leaves minus those that it enters: how many contain its start
};

/// `from` and `way` are in world space, `way` has unit length. Hits nearer than `least_m` do not count as the nearest.
RayHit cast_ray(const pack::Contents& pack, const glm::dvec3& from, const glm::dvec3& way, double least_m);

/// `count` directions, spread evenly over the sphere or cone into which the light shines; the same in every call.
std::vector<glm::dvec3> directions_of(const pack::Light& light, int count);

/// The numbers of the batch instances that may move. No hierarchy contains them.
std::vector<uint32_t> moving_batch_instances(const pack::Contents& pack);

/// The distance of the nearest triangle that casts a shadow; `most_m` if none is nearer. Cut-outs are ignored, and
/// moving triangles count at rest. `moving`: the result of moving_batch_instances, which all lights share.
double nearest_caster_m(const pack::Contents& pack, const std::vector<uint32_t>& moving, const glm::dvec3& at,
                        double most_m);

/// Whether a triangle has points within the range of a point or spot light, and points within its cone, which may be
/// others. So only `false` is certain. Moving triangles count at rest.
bool reaches_anything(const pack::Contents& pack, const pack::Light& light);

}  // namespace chandelier::baker
