// SPDX-License-Identifier: Apache-2.0
// Deliver answer `textures` (LightCluster §3.2.2): the visibility of a map, one byte for each pixel of the rectangle of
// the picture that its lights can reach.
#pragma once

#include "lights/light_list.h"
#include "recipe_schema.h"

namespace chandelier {

/// Does an answer keep visibility in textures? Throws std::invalid_argument where it is not known.
inline bool has_textures(Deliver answer) {
  switch (answer) {
    case Deliver::inlined:
      return false;
    case Deliver::textures:
      return true;
  }
  refuse_answer(answer);
}

/// Pixels [x, x + width) by [y, y + height) of a picture.
struct PixelRect {
  uint32_t x = 0;
  uint32_t y = 0;
  uint32_t width = 0;
  uint32_t height = 0;
};

/// The pixels whose line of sight may meet a sphere; all of them where the eye is in it. Conservative.
PixelRect sphere_rect(const Camera& camera, uint32_t width, uint32_t height, const glm::vec3& center_ws,
                      float radius_m);

/// Fills in the rectangles of `list.maps`: what C_att reaches; the whole picture for a directional light.
void place_visibility_rects(LightList& list, const Camera& camera, uint32_t width, uint32_t height);

inline uint64_t visibility_bytes(const frame::ShadowMap& map) {
  return uint64_t{map.rect_width} * map.rect_height;
}

}  // namespace chandelier
