// SPDX-License-Identifier: Apache-2.0
// Store answer `cube-array`: a pool of cubes, which are six layers each. A map takes six layers of it or, where it is
// smaller, the same square of all six. Where there are more maps than fit, the frame draws and shades them in groups.
#pragma once

#include "gpu/frames.h"
#include "gpu/resources.h"
#include "recipe_schema.h"
#include "shadows/store/cube_bytes.h"
#include "shadows/store/kept_maps.h"

namespace chandelier {

struct CubeArray {
  gpu::Image depth;               // its own view is a 2D array: cascades are read through it, and it is drawn to
  gpu::Owned<VkImageView> cubes;  // the same layers as a cube array
  uint32_t layer_size_px = 0;
  uint32_t cube_count = 0;
  bool is_new = true;  // in no layout yet
  KeptMaps maps;       // what lies where
};

/// How many cubes the pool may have: at least one.
uint32_t cubes_within(const gpu::Device& device, uint32_t face_size_px, uint64_t budget_bytes);

CubeArray make_cube_array(const gpu::Device& device, uint32_t layer_size_px, uint32_t cube_count);

/// Is any of the maps smaller than the layers?
bool has_parts_of_layers(std::span<const frame::ShadowMap> maps, const CubeArray& store);

/// Keeps a pool that has `cubes` cubes of the recipe's size, and retires one that has not.
void make_room(const gpu::Device& device, const Recipe& recipe, uint32_t cubes, gpu::Retired& retired,
               CubeArray& store);

}  // namespace chandelier
