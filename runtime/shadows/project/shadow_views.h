// SPDX-License-Identifier: Apache-2.0
// The project stage: a light's depths onto the six faces of a cube; a directional light's onto six cascades.
#pragma once

#include <vector>

#include "lights/light_list.h"
#include "world/bounds.h"

namespace chandelier {

/// Fills first_view and view_count of `list.maps`, which have their sizes, and returns the views map by map. A view's
/// `layer` is a face number, 0 to 5: where in the store the map lies is decided later. A map whose lights are all spot
/// lights has only the faces that one of them reaches.
std::vector<frame::ShadowView> project_lights(LightList& list, const Camera& camera, float aspect,
                                              const Bounds& bounds);

/// Looks from the origin along face `face` of a cube in Vulkan's order (+x, -x, +y, -y, +z, -z): the axes of the face's
/// s, t and of its major direction.
struct CubeFace {
  glm::vec3 s;
  glm::vec3 t;
  glm::vec3 major;
};
CubeFace cube_face(uint32_t face);

}  // namespace chandelier
