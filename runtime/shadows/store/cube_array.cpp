// SPDX-License-Identifier: Apache-2.0
#include "shadows/store/cube_array.h"

#include <algorithm>

namespace chandelier {

uint32_t cubes_within(const gpu::Device& device, uint32_t face_size_px, uint64_t budget_bytes) {
  const uint64_t by_budget = budget_bytes / cube_bytes(face_size_px);
  const uint64_t by_layers = std::min(device.limits.maxImageArrayLayers, device.limits.maxFramebufferLayers) / 6;
  return static_cast<uint32_t>(std::max<uint64_t>(1, std::min(by_budget, by_layers)));
}

CubeArray make_cube_array(const gpu::Device& device, uint32_t layer_size_px, uint32_t cube_count) {
  if (layer_size_px > device.limits.maxImageDimensionCube)
    throw gpu::Error("shadow faces of " + std::to_string(layer_size_px) + " texels are too large for this device (" +
                     std::to_string(device.limits.maxImageDimensionCube) + ")");
  CubeArray store;
  store.depth =
      gpu::make_image(device, {.format = VK_FORMAT_D32_SFLOAT,
                               .width = layer_size_px,
                               .height = layer_size_px,
                               .layers = 6 * cube_count,
                               .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                               .flags = VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT,
                               .view_type = VK_IMAGE_VIEW_TYPE_2D_ARRAY});
  store.cubes = gpu::make_view(device, store.depth, VK_IMAGE_VIEW_TYPE_CUBE_ARRAY, 0, 6 * cube_count);
  store.layer_size_px = layer_size_px;
  store.cube_count = cube_count;
  store.maps = KeptMaps(layer_size_px, cube_count);
  return store;
}

bool has_parts_of_layers(std::span<const frame::ShadowMap> maps, const CubeArray& store) {
  return std::ranges::any_of(maps, [&](const frame::ShadowMap& map) { return map.size_px != store.layer_size_px; });
}

void make_room(const gpu::Device& device, const Recipe& recipe, uint32_t cubes, gpu::Retired& retired,
               CubeArray& store) {
  const uint32_t size_px = recipe.face_size_px;
  if (store.layer_size_px == size_px && store.cube_count >= cubes) return;
  const uint32_t most = std::max(cubes, cubes_within(device, size_px, recipe.shadow_budget_bytes));
  if (store.layer_size_px == size_px) cubes = std::clamp(store.cube_count + store.cube_count / 2, cubes, most);
  retired.add(std::exchange(store, make_cube_array(device, size_px, cubes)));
}

}  // namespace chandelier
