// SPDX-License-Identifier: Apache-2.0
// Cutting in double precision, then rounding to the floats that a pack has.
#include "clip.h"

#include <bit>
#include <cstring>
#include <string>

#include "../error.h"

namespace chandelier::baker {
namespace {

/// Where the edge between two vertices meets a plane, computed from the lower one upwards: triangles that share the
/// edge get the same vertex, so that no crack opens between them.
ClipVertex crossing(const ClipVertex& low, const ClipVertex& high, int axis, double plane) {
  const double t = (plane - low.position[axis]) / (high.position[axis] - low.position[axis]);
  ClipVertex out{low.position + t * (high.position - low.position), low.uv + t * (high.uv - low.uv)};
  out.position[axis] = plane;
  return out;
}

/// Removes the sign of zero, so that equal vertices have equal bytes.
pack::VoxelVertex rounded(const ClipVertex& vertex) {
  return {glm::vec3(vertex.position) + 0.0f, glm::vec2(vertex.uv) + 0.0f};
}

double area_m2(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// A triangle of a piece that is being built.
struct CutTriangle {
  uint32_t cell;
  std::array<pack::VoxelVertex, 3> corners;
};

/// Cuts the triangles of one batch.
class BatchCutter {
 public:
  BatchCutter(const PlacedBatch& placed, const Grid& grid, std::atomic<uint64_t>& total, VoxelBlock& block)
      : placed_(placed), total_(total), block_(block), clipper_(grid) {
    const pack::Material& material = placed.pack.materials[placed.batch.material];
    masked_ = material.alpha_mode == pack::AlphaMode::mask && material.base_color_texture != pack::none;
    uv1_ = (material.uv1_mask & 1) != 0;
  }

  void cut_all() {
    for (uint32_t t = 0; t < placed_.triangle_count(); ++t) {
      const size_t before = triangles_.size();
      const std::array<ClipVertex, 3> corners = corners_of(t);
      block_.input_area_m2 += area_m2(corners[0].position, corners[1].position, corners[2].position);
      clipper_.cut(corners, [&](uint32_t cell, const ClipPolygon& polygon) { fan(cell, polygon); });
      const uint64_t added = triangles_.size() - before;
      if (total_.fetch_add(added, std::memory_order_relaxed) + added > most_clipped_triangles) {
        fail("scene", "clipped to voxels it has more than " + std::to_string(most_clipped_triangles) +
                          " triangles: take fewer --voxels, or --voxel-large separate");
      }
    }
  }

  /// Sorted by cell, in the order of the batch's triangles.
  void append_pieces() {
    std::vector<uint64_t> order(triangles_.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = uint64_t{triangles_[i].cell} << 32 | i;
    std::sort(order.begin(), order.end());
    UniqueVertices unique;
    for (size_t i = 0; i < order.size();) {
      VoxelPiece piece{.cell = static_cast<uint32_t>(order[i] >> 32), .batch_instance = placed_.batch_instance};
      piece.first_number = static_cast<uint32_t>(block_.numbers.size());
      piece.first_vertex = static_cast<uint32_t>(block_.vertices.size());
      const size_t first = i;
      while (i < order.size() && order[i] >> 32 == piece.cell) ++i;
      piece.triangle_count = static_cast<uint32_t>(i - first);
      unique.reset(3 * (i - first));
      for (size_t k = first; k < i; ++k) {
        for (const pack::VoxelVertex& corner : triangles_[static_cast<uint32_t>(order[k])].corners) {
          block_.numbers.push_back(static_cast<uint16_t>(unique.add(corner)));
        }
      }
      block_.vertices.insert(block_.vertices.end(), unique.vertices().begin(), unique.vertices().end());
      piece.vertex_count = static_cast<uint32_t>(unique.vertices().size());
      block_.pieces.push_back(piece);
    }
  }

 private:
  std::array<ClipVertex, 3> corners_of(uint32_t t) const {
    const Triangle positions = placed_.triangle_ws(t);
    std::array<ClipVertex, 3> out;
    for (uint32_t c = 0; c < 3; ++c) {
      out[c].position = positions[c];
      if (!masked_) continue;
      const pack::VertexAttributes& attributes = placed_.pack.vertex_attributes[placed_.vertex(t, c)];
      out[c].uv = uv1_ ? attributes.uv1 : attributes.uv0;
    }
    return out;
  }

  /// Triangles that rounding leaves without area are dropped.
  void fan(uint32_t cell, const ClipPolygon& polygon) {
    for (size_t i = 2; i < polygon.size(); ++i) {
      const CutTriangle cut{cell, {rounded(polygon[0]), rounded(polygon[i - 1]), rounded(polygon[i])}};
      const double area = area_m2(cut.corners[0].position_ws, cut.corners[1].position_ws, cut.corners[2].position_ws);
      if (!(area > 0)) continue;
      block_.clipped_area_m2 += area;
      triangles_.push_back(cut);
    }
  }

  const PlacedBatch& placed_;
  std::atomic<uint64_t>& total_;
  VoxelBlock& block_;
  Clipper clipper_;
  bool masked_ = false, uv1_ = false;
  std::vector<CutTriangle> triangles_;
};

}  // namespace

void split(const ClipPolygon& polygon, int axis, double plane, ClipPolygon& below, ClipPolygon& above) {
  below.clear();
  above.clear();
  for (size_t i = 0; i < polygon.size(); ++i) {
    const ClipVertex &a = polygon[i], &b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double from = a.position[axis], to = b.position[axis];
    if (from <= plane) below.push_back(a);
    if (from >= plane) above.push_back(a);
    if ((from < plane && to > plane) || (from > plane && to < plane)) {
      below.push_back(from < to ? crossing(a, b, axis, plane) : crossing(b, a, axis, plane));
      above.push_back(below.back());
    }
  }
}

void UniqueVertices::reset(size_t most_vertices) {
  vertices_.clear();
  slots_.assign(std::bit_ceil(2 * most_vertices + 1), pack::none);
}

uint32_t UniqueVertices::add(const pack::VoxelVertex& vertex) {
  std::array<uint32_t, 5> words;
  static_assert(sizeof(words) == sizeof(vertex));
  std::memcpy(words.data(), &vertex, sizeof(words));
  uint64_t hash = 0;
  for (const uint32_t word : words) hash = std::rotl((hash ^ word) * 0x9E3779B97F4A7C15u, 29);
  const size_t mask = slots_.size() - 1;
  for (size_t slot = hash & mask;; slot = (slot + 1) & mask) {
    if (slots_[slot] == pack::none) {
      slots_[slot] = static_cast<uint32_t>(vertices_.size());
      vertices_.push_back(vertex);
      return slots_[slot];
    }
    if (std::memcmp(&vertices_[slots_[slot]], &vertex, sizeof(vertex)) == 0) return slots_[slot];
  }
}

void bin_clipped(const PlacedBatch& placed, const Grid& grid, std::atomic<uint64_t>& total, VoxelBlock& block) {
  BatchCutter cutter(placed, grid, total, block);
  cutter.cut_all();
  cutter.append_pieces();
}

}  // namespace chandelier::baker
