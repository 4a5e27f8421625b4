// SPDX-License-Identifier: Apache-2.0
// One primitive, cut into batches and put in order, ready to be written.
#pragma once

#include <cstdint>

#include "packed.h"

namespace chandelier::baker {

struct CutPrimitive {
  std::vector<PackedVertex> vertices;     // as they came
  std::vector<SkinVertex> skin_vertices;  // as they came
  std::vector<uint32_t> vertex_order;     // numbers of `vertices`, as the batches use them first
  std::vector<uint32_t> indices;          // into vertex_order, batch after batch
  std::vector<uint32_t> batch_counts;     // of triangles, per batch
  size_t closed_batches = 0;              // the first ones
  uint32_t material = 0;
};

CutPrimitive cut_into_batches(PackedPrimitive&& primitive, size_t batch_triangles);

}  // namespace chandelier::baker
