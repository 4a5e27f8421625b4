// SPDX-License-Identifier: Apache-2.0
// Finds what is around a light: rays against a pack's static triangles, and whether any triangle is within its range.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "pack_schema.h"

namespace chandelier::baker {

/// What a ray hits. Triangles that cast no shadow do not count, nor do masked materials, since textures are not read
/// here.
struct RayHit {
  double distance_m = INFINITY;  // of the first triangle
  bool closed_back = false;      // it is the back of a closed shell
  bool double_sided = false;     // its material shows its back
  int shells_around = 0;         // closed shells left less those entered: how many hold the ray's start
};

/// `from` and `way` in the world, `way` of unit length. Nothing nearer than `least_m` counts as first.
RayHit cast_ray(const pack::Contents& pack, const glm::dvec3& from, const glm::dvec3& way, double least_m);

/// `count` directions, spread evenly over what a point or spot light shines into; always the same.
std::vector<glm::dvec3> directions_of(const pack::Light& light, int count);

/// The numbers of those that no hierarchy holds, since they may move.
std::vector<uint32_t> moving_batch_instances(const pack::Contents& pack);

/// How far the nearest triangle is that casts a shadow, wherever its cut-outs are, and where it rests if it moves;
/// `most_m` where none is nearer. `moving`: moving_batch_instances, so that many lights need them only once.
double nearest_caster_m(const pack::Contents& pack, const std::vector<uint32_t>& moving, const glm::dvec3& at,
                        double most_m);

/// Whether a triangle has points within a point or spot light's range and points, maybe others, within its cone. So
/// false is certain. Moving triangles count at rest.
bool reaches_anything(const pack::Contents& pack, const pack::Light& light);

}  // namespace chandelier::baker
