// SPDX-License-Identifier: Apache-2.0
// Divides triangles into batches of neighbours, top down, by the surface area heuristic.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh_item.h"

namespace chandelier::baker {

/// The box of a triangle, with its number.
BvhItem triangle_box(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint32_t triangle);

struct BatchOrder {
  std::vector<uint32_t> triangles;  // numbers of all triangles, sorted by batch; neighbours are near each other
  std::vector<uint32_t> counts;     // of triangles, per batch
};

/// Splits triangles into batches of at most `most`. The result does not depend on the number of threads.
BatchOrder split_into_batches(std::vector<BvhItem>&& boxes, size_t most);

}  // namespace chandelier::baker
