// SPDX-License-Identifier: Apache-2.0
// A world's geometry, materials and textures as the GPU reads them; lights stay on the CPU, where they are selected.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "gpu/pipelines.h"
#include "gpu/uploader.h"
#include "world/world.h"

namespace chandelier {

struct GpuScene {
  gpu::Buffer positions;          // vertex stream: pack Position
  gpu::Buffer vertex_attributes;  // vertex stream: pack VertexAttributes
  gpu::Buffer indices;
  gpu::Buffer batches;
  gpu::Buffer instances;
  gpu::Buffer batch_instances;
  gpu::Buffer materials;
  gpu::Buffer uv_transforms;  // ten rows of three floats per material, two for each of its five textures
  uint32_t batch_instance_count = 0;

  std::vector<bool> double_sided;  // per material
  std::vector<gpu::Image> images;  // the pack's, then one white texel
  std::vector<gpu::Owned<VkSampler>> samplers;
  gpu::Owned<VkDescriptorSetLayout> material_layout;  // set 1: the five textures of a material
  gpu::Owned<VkDescriptorPool> material_pool;
  std::vector<VkDescriptorSet> material_sets;

  Version instances_version = 0;  // of the world, that instances and batch_instances hold
};

struct UploadOptions {
  float anisotropy = 1.0f;       // of texture fetches on slanted surfaces: 1 none, to 16
  gpu::UploadProgress progress;  // may be empty
};
/// Throws gpu::Error, also where the scene is too large for the device.
GpuScene upload_scene(const gpu::Device& device, const World& world, const UploadOptions& options = {});

/// The vertex streams of GpuScene: positions alone for depth, both for shading.
std::vector<gpu::VertexStream> position_stream();
std::vector<gpu::VertexStream> position_and_attribute_streams();

}  // namespace chandelier
