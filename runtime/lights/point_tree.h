// SPDX-License-Identifier: Apache-2.0
// A k-d tree of positions (Bentley 1975), four boxes to a node: what is near a point?
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace chandelier::lights {

/// A radius as the tree compares it: squared, and so much larger that rounding and overflow of floats lose nothing.
class SquaredRadius {
 public:
  explicit SquaredRadius(double radius_m)
      : squared_(static_cast<float>(std::min(radius_m * radius_m, most)) * (1.0f + 1e-5f) +
                 std::numeric_limits<float>::min()) {}
  bool reaches(float squared_distance) const { return !(squared_distance > squared_); }

 private:
  static constexpr double most = std::numeric_limits<float>::max();
  float squared_;
};

class PointTree {
 public:
  struct Point {
    glm::vec3 position_ws;
    uint32_t number;
  };

  explicit PointTree(std::vector<Point> points);

  /// Calls visit(number) for every point within a radius of `p`, and maybe for some that are hardly farther. The radius
  /// is looked at anew for each, so that a visit may shrink it.
  template <typename Visit>
  void visit_near(const glm::vec3& p, const SquaredRadius& radius, Visit visit) const;

 private:
  static constexpr uint32_t leaf_points = 12;
  static constexpr uint32_t leaf_bit = 0x80000000u;

  using Four = std::array<float, 4>;
  struct Node {  // of each of four parts of the points
    std::array<Four, 3> min_ws;
    std::array<Four, 3> max_ws;
    std::array<uint32_t, 4> first;  // its node, or in a leaf its first point
    std::array<uint32_t, 4> count;  // 0, or in a leaf leaf_bit and the number of points
  };

  void halve(uint32_t first, uint32_t middle, uint32_t end);
  uint32_t build(uint32_t first, uint32_t end);
  static Four squared_distances(const Node& node, const glm::vec3& p);
  static float squared_distance(const Point& point, const glm::vec3& p) {
    const glm::vec3 d = point.position_ws - p;
    return d.x * d.x + d.y * d.y + d.z * d.z;
  }

  std::vector<Point> points_;
  std::vector<Node> nodes_;
};

// Without comparisons, which would keep compilers from working on four boxes at once: x + |x| is 2 max(x, 0). Where the
// difference of two floats is infinite this may be no number, which a radius is said to reach.
inline PointTree::Four PointTree::squared_distances(const Node& node, const glm::vec3& p) {
  Four sum{};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 4; ++i) {
      const float below = node.min_ws[axis][i] - p[axis], above = p[axis] - node.max_ws[axis][i];
      const float outside = 0.5f * ((below + std::abs(below)) + (above + std::abs(above)));
      sum[i] += outside * outside;
    }
  }
  return sum;
}

template <typename Visit>
void PointTree::visit_near(const glm::vec3& p, const SquaredRadius& radius, Visit visit) const {
  if (nodes_.empty()) return;
  std::array<uint32_t, 64> stack;  // quartering 2^32 points takes 16 levels, of which each leaves three to wait
  uint32_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = nodes_[stack[--waiting]];
    const Four distances = squared_distances(node, p);
    for (uint32_t part = 0; part < 4; ++part) {
      if (!radius.reaches(distances[part])) continue;
      if (node.count[part] == 0) {
        stack[waiting++] = node.first[part];
        continue;
      }
      const uint32_t end = node.first[part] + (node.count[part] ^ leaf_bit);
      for (uint32_t i = node.first[part]; i < end; ++i)
        if (radius.reaches(squared_distance(points_[i], p))) visit(points_[i].number);
    }
  }
}

}  // namespace chandelier::lights
