// SPDX-License-Identifier: Apache-2.0
// Tests of a ray against boxes and triangles; neighbours get the same answer at a shared edge.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace chandelier::rays {

/// The points from + t · way, with t between `nearest` and `farthest`. `way` has any length but 0.
class Ray {
 public:
  Ray(const glm::vec3& from, const glm::vec3& way, float t_nearest, float t_farthest)
      : nearest(t_nearest), farthest(t_farthest), from_(from), major_(largest_axis(way)) {
    for (int axis = 0; axis < 3; ++axis) {
      // A component of 0 would make a box's face through the start 0 · infinity.
      const float component = std::abs(way[axis]) < 1e-30f ? std::copysign(1e-30f, way[axis]) : way[axis];
      per_way_[axis] = 1.0f / component;
    }
    x_ = (major_ + 1) % 3;
    y_ = (major_ + 2) % 3;
    if (way[major_] < 0.0f) std::swap(x_, y_);
    shear_ = glm::vec3(way[x_], way[y_], 1.0f) / way[major_];
  }

  float nearest;
  float farthest;

  /// Whether the ray may hit something in the box; false only if it cannot (Ize 2013, robust BVH ray traversal).
  bool meets_box(const glm::vec3& low, const glm::vec3& high) const {
    const glm::vec3 a = (low - from_) * per_way_, b = (high - from_) * per_way_;
    const glm::vec3 enter = glm::min(a, b), leave = glm::max(a, b);
    const float first = std::max(std::max(enter.x, enter.y), std::max(enter.z, nearest));
    const float last = std::min(std::min(leave.x, leave.y), leave.z) * (1.0f + 4e-7f);
    return first <= std::min(last, farthest);
  }

  /// The t at which the ray meets the triangle from either side, else infinity. Two triangles that share an edge leave
  /// no gap between them (Woop, Benthin, Wald 2013, watertight ray/triangle intersection).
  float intersect_triangle(const std::array<glm::vec3, 3>& corners) const {
    glm::vec2 p[3];
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 d = corners[i] - from_;
      p[i] = glm::vec2(d[x_] - shear_.x * d[major_], d[y_] - shear_.y * d[major_]);
    }
    float u = p[2].x * p[1].y - p[2].y * p[1].x;
    float v = p[0].x * p[2].y - p[0].y * p[2].x;
    float w = p[1].x * p[0].y - p[1].y * p[0].x;
    if (u == 0.0f || v == 0.0f || w == 0.0f) {  // on an edge, or too near to one for a float
      u = cross_in_double(p[2], p[1]);
      v = cross_in_double(p[0], p[2]);
      w = cross_in_double(p[1], p[0]);
    }
    if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return INFINITY;
    const float whole = u + v + w;
    if (whole == 0.0f) return INFINITY;
    const float depth = u * (corners[0][major_] - from_[major_]) + v * (corners[1][major_] - from_[major_]) +
                        w * (corners[2][major_] - from_[major_]);
    const float t = shear_.z * depth / whole;
    return t > nearest && t < farthest ? t : INFINITY;
  }

 private:
  static int largest_axis(const glm::vec3& v) {
    const glm::vec3 a = glm::abs(v);
    return a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  }
  static float cross_in_double(const glm::vec2& a, const glm::vec2& b) {
    return static_cast<float>(double{a.x} * double{b.y} - double{a.y} * double{b.x});
  }

  glm::vec3 from_;
  glm::vec3 per_way_;
  int major_;  // the axis that the way follows most; x_ and y_ are the others
  int x_;
  int y_;
  glm::vec3 shear_;
};

}  // namespace chandelier::rays
