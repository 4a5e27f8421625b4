// SPDX-License-Identifier: Apache-2.0
// Cull answer `light-frustum` on the CPU, for predictions: what cull_light_frustum.comp does, in the same arithmetic.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "frame_schema.h"
#include "pack_schema.h"

namespace chandelier {

class CullLightFrustum {
 public:
  explicit CullLightFrustum(const frame::ShadowView& view) : view_(view) {
    const auto& c = view.clip_from_center;
    const glm::mat4 rows = glm::transpose(glm::mat4(c[0], c[1], c[2], c[3]));
    planes_ = {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1], rows[3] - rows[2], rows[2]};
  }

  bool survives(const pack::BatchInstance& candidate) const {
    if (!reaches(candidate)) return false;
    const glm::vec3 low = candidate.bounds_min_ws - view_.center_ws, high = candidate.bounds_max_ws - view_.center_ws;
    for (const glm::vec4& plane : planes_)
      if (!inside(plane, low, high)) return false;
    return true;
  }

 private:
  bool reaches(const pack::BatchInstance& candidate) const {
    const glm::vec3 nearest = glm::clamp(view_.center_ws, candidate.bounds_min_ws, candidate.bounds_max_ws);
    const glm::vec3 d = nearest - view_.center_ws;
    return view_.range_m == 0.0f || glm::dot(d, d) <= view_.range_m * view_.range_m;
  }

  static bool inside(const glm::vec4& plane, const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 corner = glm::mix(low, high, glm::greaterThan(glm::vec3(plane), glm::vec3(0.0f)));
    return glm::dot(glm::vec3(plane), corner) + plane.w >= 0.0f;
  }

  const frame::ShadowView& view_;
  std::array<glm::vec4, 6> planes_;
};

}  // namespace chandelier
