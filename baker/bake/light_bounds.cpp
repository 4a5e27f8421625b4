// SPDX-License-Identifier: Apache-2.0
// A spot light reaches a spherical sector: a cone of half angle a, with its cap. The smallest sphere around it touches,
//   a up to 45°:  the tip and the rim. Tip, rim and centre make an isosceles triangle: radius = range / (2 cos a);
//   a up to 90°:  the rim alone, whose circle is the widest there is: radius = range sin a, centre at range cos a;
//   above:        a whole great circle: the light's whole range.
#include "light_bounds.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace chandelier::baker {

Sphere light_bounds(const pack::Light& light) {
  const glm::dvec3 tip(light.position_ws);
  const double range = light.range_m, cosine = light.outer_cone_cos;
  if (light.type != pack::LightType::spot || cosine <= 0) return {tip, range};
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double radius = cosine >= sine ? range / (2 * cosine) : range * sine;
  const double ahead = cosine >= sine ? radius : range * cosine;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction_ws));
  return {tip + axis * ahead, radius};
}

Sphere enclosing(const Sphere& a, const Sphere& b) {
  const glm::dvec3 apart = b.center - a.center;
  const double distance = glm::length(apart);
  if (distance + b.radius <= a.radius) return a;
  if (distance + a.radius <= b.radius) return b;
  const double radius = 0.5 * (distance + a.radius + b.radius);
  return {a.center + apart * ((radius - a.radius) / distance), radius};
}

FloatSphere rounded_outwards(const Sphere& sphere) {
  FloatSphere out;
  for (int axis = 0; axis < 3; ++axis) {
    out.center[axis] = static_cast<float>(std::clamp(sphere.center[axis], -double{FLT_MAX}, double{FLT_MAX}));
  }
  const double radius = sphere.radius + glm::distance(sphere.center, glm::dvec3(out.center));
  out.radius = static_cast<float>(std::min(radius, double{FLT_MAX}));
  if (double{out.radius} < radius && out.radius < FLT_MAX) out.radius = std::nextafter(out.radius, FLT_MAX);
  return out;
}

}  // namespace chandelier::baker
