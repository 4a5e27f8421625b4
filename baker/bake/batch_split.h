// SPDX-License-Identifier: Apache-2.0
// Divides triangles into batches of neighbours, top down, by the surface area heuristic.
#pragma once

#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// The box of a triangle. Four floats a side, so that both sides are one vector register each.
struct TriangleBox {
  float low[4] = {};
  float high[4] = {};
  // What the fourth floats hold, as bits: the triangle's number in low, whether it begins a batch in high.
};

TriangleBox triangle_box(const float* a, const float* b, const float* c, std::uint32_t triangle);

struct BatchOrder {
  std::vector<std::uint32_t> triangles;  // numbers of all triangles, batch after batch, neighbours near each other
  std::vector<std::uint32_t> counts;     // of triangles, per batch
};

/// Batches of at most `most` triangles. The same on any number of threads.
BatchOrder split_into_batches(std::vector<TriangleBox>&& boxes, std::size_t most);

}  // namespace chandelier::baker
