// SPDX-License-Identifier: Apache-2.0
// Whether a triangle reaches into a box, so that no overlap is missed (Akenine-Möller 2001, separating axes).
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace chandelier::baker {

using Triangle = std::array<glm::dvec3, 3>;

/// False only where the closed triangle and the closed box have no point in common, corners off by up to `slack`
/// included, as long as slack ≥ 2⁻⁴⁷ times the largest coordinate. True wherever they have one, and perhaps where they
/// are within a few times `slack` of it.
bool may_overlap(const Triangle& triangle, const glm::dvec3& box_min, const glm::dvec3& box_max, double slack);

}  // namespace chandelier::baker
