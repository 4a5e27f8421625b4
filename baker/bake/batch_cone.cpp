// SPDX-License-Identifier: Apache-2.0
// The axis is the mean normal; the widest normal is θ away from it; the apex lies behind every triangle's plane. An eye
// e that looks at the apex within 90° − θ of the axis looks within 90° of each normal n, so n · (apex − e) ≥ 0; and n ·
// (p − apex) ≥ 0 for the plane's points p, so n · (p − e) ≥ 0: a back.
#include "batch_cone.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

constexpr double widest = 0.1;        // smallest cosine of θ; a wider cone would hardly ever cull
constexpr double margin = 1e-4;       // on the cutoff, for a test in floats
constexpr double apex_margin = 1e-5;  // of the size of the coordinates, for an apex in floats

glm::dvec3 normal_of(const glm::vec3* corner) {
  const glm::dvec3 a = corner[0];
  return glm::normalize(glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a));
}

}  // namespace

NormalCone normal_cone(std::span<const glm::vec3> corners) {
  glm::dvec3 sum(0), low(INFINITY), high(-INFINITY);
  for (size_t i = 0; i < corners.size(); i += 3) sum += normal_of(&corners[i]);
  for (const glm::vec3& corner : corners)
    low = glm::min(low, glm::dvec3(corner)), high = glm::max(high, glm::dvec3(corner));
  const double length = glm::length(sum);
  if (!(length > 1e-6) || !std::isfinite(length)) return {};
  const glm::vec3 axis = glm::vec3(sum / length);  // rounded as in the pack

  const glm::dvec3 center = 0.5 * low + 0.5 * high;
  double least = 1, back = -INFINITY;  // cosine of θ; how far behind the centre the apex must be
  for (size_t i = 0; i < corners.size(); i += 3) {
    const glm::dvec3 normal = normal_of(&corners[i]);
    const double cosine = glm::dot(normal, glm::dvec3(axis));
    least = std::min(least, cosine);
    if (least <= widest) return {};
    back = std::max(back, glm::dot(center - glm::dvec3(corners[i]), normal) / cosine);
  }
  const double sine = std::sqrt(std::max(0.0, 1 - least * least)) + margin;
  const glm::dvec3 reach = glm::max(glm::abs(low), glm::abs(high));
  back += apex_margin * std::max({reach.x, reach.y, reach.z}) / widest;
  const glm::vec3 apex(center - back * glm::dvec3(axis));
  const bool usable = sine < 1 && std::isfinite(apex.x) && std::isfinite(apex.y) && std::isfinite(apex.z);
  return usable ? NormalCone{apex, axis, static_cast<float>(sine)} : NormalCone{};
}

}  // namespace chandelier::baker
