// SPDX-License-Identifier: Apache-2.0
// What a frame is asked to be.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "frame/recipe.h"
#include "lights/ambient.h"
#include "shadows/cull/draw_lists.h"
#include "shadows/filter/visibility_query.h"
#include "view/camera.h"

namespace chandelier {

struct RenderSettings {
  Recipe recipe;
  Camera camera;
  uint32_t width = 1280;
  uint32_t height = 720;
  uint32_t samples = 1;                    // in a pixel: 1, or 2, 4, 8 where can_draw_samples() (shading/targets.h)
  Ambient ambient;                         // light from everywhere, for scenes that would be black without
  float headlight = 0.0f;                  // of a white surface that faces the camera, by a light in the camera
  std::optional<float> exposure_ev;        // stops; absent: from the picture's own brightness
  std::vector<uint32_t> previous_centers;  // FrameStats::centers of the frame before, where the recipe has stability
  std::vector<uint32_t> centers;           // whose map each light of the world takes; pack::none, or none: as selected
  uint64_t most_caster_draws = chandelier::most_caster_draws;  // kept at a time; what exceeds them takes more passes
  /// Shadow maps whose depths are in the store from an earlier frame are not drawn again. The picture is the same; a
  /// frame's counters of draws and triangles then depend on the frames before.
  bool keep_shadow_maps = false;
  bool lights_out_of_view = false;  // are selected too, as for a camera that looks everywhere
  /// Select error-driven: a new view's search runs in a thread, and frames go on with the last answer until it ends
  /// (Renderer::has_new_selection()). Else draw() waits for it.
  bool search_beside_frames = false;
  VisibilitySource visibility;  // needed by filter rays, unused by others

  bool operator==(const RenderSettings&) const = default;
};

/// Width over height.
inline float aspect_of(const RenderSettings& settings) {
  return static_cast<float>(settings.width) / static_cast<float>(settings.height);
}

}  // namespace chandelier
