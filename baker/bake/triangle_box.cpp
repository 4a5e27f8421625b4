// SPDX-License-Identifier: Apache-2.0
// Why no overlap is missed. Two convex sets whose projections on any axis a are disjoint are disjoint. So it
// does not matter how well the thirteen axes are computed, only that projections are not narrower than they are. Let
// e = 2⁻⁵³, S the largest coordinate, w the triangle's corners relative to the box's centre c, h the box's half size.
//   - c, h and w take one or two roundings each of numbers below 2 S: each is off by at most 4 e S.
//   - a·w, a sum of three products, is off by at most 3 e · 2 S · |a|₁, and r = Σ h |aᵢ| by at most 4 e · 2 S · |a|₁.
// Together that is below 32 e S |a|₁ = 2⁻⁴⁸ S |a|₁. The box grows by `slack` on each side, which adds slack · |a|₁ to
// r: with slack ≥ 2⁻⁴⁷ S at least 2⁻⁴⁸ S is left for corners that are themselves rounded. Products do not overflow
// (coordinates are floats: below 2¹²⁸, so a below 2²⁵⁸), and where an axis underflows to zero it separates nothing.
#include "triangle_box.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

/// Whether the projections on `axis` of the triangle and of a box around the origin are apart.
bool apart(const Triangle& triangle, const glm::dvec3& half, const glm::dvec3& axis) {
  const double a = glm::dot(axis, triangle[0]), b = glm::dot(axis, triangle[1]), c = glm::dot(axis, triangle[2]);
  const double r = glm::dot(half, glm::abs(axis));
  return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
}

}  // namespace

bool may_overlap(const Triangle& triangle, const glm::dvec3& box_min, const glm::dvec3& box_max, double slack) {
  const glm::dvec3 center = 0.5 * (box_min + box_max), half = 0.5 * (box_max - box_min) + slack;
  const Triangle w = {triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const glm::dvec3 low = glm::min(glm::min(w[0], w[1]), w[2]), high = glm::max(glm::max(w[0], w[1]), w[2]);
  if (glm::any(glm::greaterThan(low, half)) || glm::any(glm::lessThan(high, -half))) return false;
  const std::array<glm::dvec3, 3> edges = {w[1] - w[0], w[2] - w[1], w[0] - w[2]};
  if (apart(w, half, glm::cross(edges[0], edges[1]))) return false;
  for (const glm::dvec3& e : edges) {
    if (apart(w, half, {0, -e.z, e.y}) || apart(w, half, {e.z, 0, -e.x}) || apart(w, half, {-e.y, e.x, 0}))
      return false;
  }
  return true;
}

}  // namespace chandelier::baker
