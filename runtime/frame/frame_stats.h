// SPDX-License-Identifier: Apache-2.0
// What frames took and did.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chandelier {

struct StageTime {
  std::string name;
  double gpu_ms = 0.0;
  double cpu_ms = 0.0;
};

/// What a frame took and did. Counters are exact and repeat from run to run.
struct FrameStats {
  double frame_ms = 0.0;  // from selecting lights to the last command finished
  std::vector<StageTime> stages;
  float exposure_ev = 0.0f;  // as used
  uint64_t lights = 0;
  uint64_t lights_in_view = 0;
  uint64_t shadowless_in_view = 0;  // of them, those that throw no shadow
  uint64_t light_clusters = 0;      // equals the number of the others where lights are not clustered
  uint64_t reference_path = 0;      // 1: clusters were asked for, but are nearly as many as lights (LightCluster §5.4)
  uint64_t shadow_maps = 0;
  uint64_t shadow_maps_kept = 0;  // of them, those that lay in the store already (RenderSettings::keep_shadow_maps)
  uint64_t shadow_views = 0;
  uint64_t shadow_triangles = 0;
  uint64_t shadow_draws = 0;
  uint64_t shadow_bytes = 0;              // depth that all shadow maps of the frame need together
  uint64_t shadow_pool_bytes = 0;         // depth held at a time
  uint64_t shadow_rounds = 0;             // how often the pool was filled
  uint64_t shadow_overflow_passes = 0;    // further passes over groups of maps, whose draws did not fit their buffer
  uint64_t visibility_bytes = 0;          // that all visibility textures of the frame need together
  uint64_t visibility_pool_bytes = 0;     // of them, held at a time
  uint64_t edge_pixels = 0;               // whose samples show several surfaces
  uint64_t edge_surfaces = 0;             // of these pixels; each was shaded apart
  uint64_t sample_bytes = 0;              // images and lists that several samples in a pixel need
  std::vector<uint32_t> centers;          // for each light of the world whose shadow map it took; pack::none: none
  bool selection_is_provisional = false;  // RenderSettings::search_beside_frames: a search for this view still runs
};

}  // namespace chandelier
