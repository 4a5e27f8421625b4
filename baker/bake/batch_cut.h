// SPDX-License-Identifier: Apache-2.0
// One primitive, cut into batches and put in order, ready to be written.
#pragma once

#include <cstdint>

#include "packed.h"

namespace chandelier::baker {

struct CutPrimitive {
  std::vector<PackedVertex> vertices;     // in the given order
  std::vector<SkinVertex> skin_vertices;  // in the given order
  std::vector<uint32_t> vertex_order;     // numbers of `vertices`, in the order of first use
  std::vector<uint32_t> indices;          // into vertex_order, sorted by batch
  std::vector<uint32_t> batch_counts;     // of triangles, of each batch
  size_t closed_batches = 0;              // how many of the first batches are closed
  uint32_t material = 0;
};

CutPrimitive cut_into_batches(PackedPrimitive&& primitive, size_t batch_triangles);

}  // namespace chandelier::baker
