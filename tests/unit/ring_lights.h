// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "lights/light_clusters.h"

namespace chandelier::lights {

// Ten circles of eight lights, as the paper's atrium has them (Table 1).
inline std::vector<ClusterLight> ring_lights() {
  std::vector<ClusterLight> lights;
  for (const float z : {-4.5f, 4.5f}) {
    for (const float x : {-10.0f, -5.0f, 0.0f, 5.0f, 10.0f}) {
      for (int i = 0; i < 8; ++i) {
        const float angle = 2.0f * 3.14159265f * static_cast<float>(i) / 8.0f;
        lights.push_back({{x + 0.44f * std::cos(angle), 2.5f, z + 0.44f * std::sin(angle)}, 7.0f});
      }
    }
  }
  return lights;
}

}  // namespace chandelier::lights
