// SPDX-License-Identifier: Apache-2.0
// How wrong a picture will look whose lights share shadow maps, before it is drawn.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "lights/light_samples.h"
#include "recipe_schema.h"

namespace chandelier {

/// A light, and the one whose shadow map it takes: indices into the samples' lights.
struct MapMember {
  uint32_t light;
  uint32_t center;
  float filter_radius_m;  // of the map, as ShadowMap has it
  float share = 1.0f;     // of the light; those of one light in several maps add up to 1
};

/// How shadow maps are read.
struct ShadowReading {
  Filter filter = Filter::pcf;
  uint32_t face_size_px = 512;
};

/// Expected root mean square error of the shown picture (0 to 1, over R, G and B) against one hard shadow map for each
/// light. `members`: every light that `samples` was made for, those of one map after each other. Throws
/// SearchStopped.
double estimated_rmse(const LightSamples& samples, std::span<const MapMember> members, const ShadowReading& reading,
                      const std::stop_token& stop = {});

}  // namespace chandelier
