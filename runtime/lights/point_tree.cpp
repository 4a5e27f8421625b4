// SPDX-License-Identifier: Apache-2.0
#include "lights/point_tree.h"

namespace chandelier::lights {

PointTree::PointTree(std::vector<Point> points) : points_(std::move(points)) {
  nodes_.reserve(points_.size() / 4 + 1);
  if (!points_.empty()) build(0, static_cast<uint32_t>(points_.size()));
}

// Across the longest side of their box, whose length may exceed what a float holds.
void PointTree::halve(uint32_t first, uint32_t middle, uint32_t end) {
  if (end - first < 2) return;
  glm::vec3 min_ws = points_[first].position_ws, max_ws = min_ws;
  for (uint32_t i = first + 1; i < end; ++i) {
    min_ws = glm::min(min_ws, points_[i].position_ws);
    max_ws = glm::max(max_ws, points_[i].position_ws);
  }
  const glm::dvec3 extent = glm::dvec3(max_ws) - glm::dvec3(min_ws);
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + end,
                   [axis](const Point& a, const Point& b) { return a.position_ws[axis] < b.position_ws[axis]; });
}

uint32_t PointTree::build(uint32_t first, uint32_t end) {
  const uint32_t count = end - first;
  const std::array<uint32_t, 5> ends{first, first + count / 4, first + count / 2,
                                     first + count / 2 + (count - count / 2) / 2, end};
  halve(first, ends[2], end);
  halve(first, ends[1], ends[2]);
  halve(ends[2], ends[3], end);

  const auto number = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  for (uint32_t part = 0; part < 4; ++part) {
    glm::vec3 min_ws(std::numeric_limits<float>::infinity()), max_ws = -min_ws;
    for (uint32_t i = ends[part]; i < ends[part + 1]; ++i) {
      min_ws = glm::min(min_ws, points_[i].position_ws);
      max_ws = glm::max(max_ws, points_[i].position_ws);
    }
    for (int axis = 0; axis < 3; ++axis) {
      nodes_[number].min_ws[axis][part] = min_ws[axis];
      nodes_[number].max_ws[axis][part] = max_ws[axis];
    }
    const uint32_t points = ends[part + 1] - ends[part];
    const bool leaf = points <= leaf_points;
    const uint32_t below = leaf ? ends[part] : build(ends[part], ends[part + 1]);
    nodes_[number].first[part] = below;
    nodes_[number].count[part] = leaf ? points | leaf_bit : 0;
  }
  return number;
}

}  // namespace chandelier::lights
