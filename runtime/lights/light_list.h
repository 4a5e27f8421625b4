// SPDX-License-Identifier: Apache-2.0
// The select stage: which lights are in view, and which of them share a shadow map.
#pragma once

#include <span>
#include <vector>

#include "frame/camera.h"
#include "frame/recipe.h"
#include "frame_schema.h"
#include "lights/walls.h"
#include "pack_schema.h"

namespace chandelier {

/// The lights that can reach something in view, those of one shadow map after each other, maps in ascending order of
/// their centre's number in the pack: with one light per map that is the pack's order.
struct LightList {
  std::vector<frame::FrameLight> lights;
  std::vector<frame::ShadowMap> maps;       // cube, first_view and view_count are still open
  std::vector<glm::vec3> map_direction_ws;  // the way that each map's centre shines: cascades are drawn along it
  std::vector<uint32_t> pack_light;         // number in the pack, of each of `lights`
  std::vector<uint32_t> center;             // number in the pack of the light whose map each of `lights` takes
};

/// Point and spot lights may share a map, and directional lights among themselves. `walls`, of the same lights, are
/// needed where the recipe looks for walls; std::invalid_argument where they are missing.
LightList select_lights(std::span<const pack::Light> lights, const Recipe& recipe, const Camera& camera, float aspect,
                        lights::Walls* walls = nullptr);

}  // namespace chandelier
