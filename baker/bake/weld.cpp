// SPDX-License-Identifier: Apache-2.0
// Welds with meshoptimizer: exact, byte by byte.
#include "weld.h"

#include <meshoptimizer.h>

namespace chandelier::baker {
namespace {

void drop_degenerate(std::vector<std::uint32_t>& indices) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
    if (a == b || b == c || c == a) continue;
    indices[kept++] = a;
    indices[kept++] = b;
    indices[kept++] = c;
  }
  indices.resize(kept);
}

}  // namespace

void weld(Primitive& primitive) {
  std::vector<std::uint32_t> remap(primitive.vertices.size());
  const std::size_t count =
      meshopt_generateVertexRemap(remap.data(), primitive.indices.data(), primitive.indices.size(),
                                  primitive.vertices.data(), primitive.vertices.size(), sizeof(Vertex));
  std::vector<Vertex> vertices(count);
  meshopt_remapVertexBuffer(vertices.data(), primitive.vertices.data(), primitive.vertices.size(), sizeof(Vertex),
                            remap.data());
  meshopt_remapIndexBuffer(primitive.indices.data(), primitive.indices.data(), primitive.indices.size(), remap.data());
  primitive.vertices = std::move(vertices);
  drop_degenerate(primitive.indices);
}

}  // namespace chandelier::baker
