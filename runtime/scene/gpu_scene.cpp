// SPDX-License-Identifier: Apache-2.0
#include "scene/gpu_scene.h"

#include <algorithm>

#include "scene/textures.h"

namespace chandelier {
namespace {

constexpr VkBufferUsageFlags storage_use = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr VkBufferUsageFlags vertex_use = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;

struct Uploads {
  const gpu::Device& device;
  gpu::Uploader uploader;

  template <typename T>
  gpu::Buffer operator()(std::span<const T> records, VkBufferUsageFlags usage, const char* what) {
    if ((usage & storage_use) && records.size_bytes() > device.limits.maxStorageBufferRange)
      throw gpu::Error(std::string(what) + " do not fit a storage buffer of this device (" +
                       std::to_string(records.size_bytes()) + " of " +
                       std::to_string(device.limits.maxStorageBufferRange) + " bytes)");
    return uploader.buffer(std::as_bytes(records), usage);
  }
};

// Nearly all of what is uploaded.
uint64_t bytes_of(const pack::View& pack) {
  uint64_t texels = 0;
  for (const pack::Image& image : pack.images) texels += image.size_bytes;
  return texels + pack.positions.size_bytes() + pack.vertex_attributes.size_bytes() + pack.indices.size_bytes() +
         pack.batches.size_bytes() + pack.batch_instances.size_bytes();
}

}  // namespace

GpuScene upload_scene(const gpu::Device& device, const World& world, const UploadOptions& options) {
  const pack::View& pack = world.pack();
  Uploads upload{device, {device, bytes_of(pack), options.progress}};
  GpuScene scene;
  scene.positions = upload(pack.positions, vertex_use, "positions");
  scene.vertex_attributes = upload(pack.vertex_attributes, vertex_use, "vertex attributes");
  scene.indices = upload(pack.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "indices");
  scene.batches = upload(pack.batches, storage_use, "batches");
  scene.instances = upload(world.instances(), storage_use, "instances");
  scene.batch_instances = upload(world.batch_instances(), storage_use, "batch instances");
  scene.materials = upload(pack.materials, storage_use, "materials");
  scene.uv_transforms = upload(std::span<const glm::vec3>(uv_rows(pack)), storage_use, "texture transforms");
  scene.batch_instance_count = static_cast<uint32_t>(pack.batch_instances.size());
  for (const pack::Material& material : pack.materials) scene.double_sided.push_back(material.double_sided != 0);
  upload_textures(device, upload.uploader, pack, options.anisotropy, scene);
  upload.uploader.finish();
  scene.instances_version = world.instances_version();
  return scene;
}

std::vector<gpu::VertexStream> position_stream() {
  return {{sizeof(pack::Position), {{"position_ls", VK_FORMAT_R32G32B32_SFLOAT, 0}}}};
}

std::vector<gpu::VertexStream> position_and_attribute_streams() {
  auto streams = position_stream();
  using V = pack::VertexAttributes;
  streams.push_back({sizeof(V),
                     {{"normal_bits", VK_FORMAT_R32_UINT, offsetof(V, normal_ls)},
                      {"tangent_bits", VK_FORMAT_R32_UINT, offsetof(V, tangent_ls)},
                      {"uv0_in", VK_FORMAT_R32G32_SFLOAT, offsetof(V, uv0)},
                      {"uv1_in", VK_FORMAT_R32G32_SFLOAT, offsetof(V, uv1)},
                      {"color_in", VK_FORMAT_R8G8B8A8_UNORM, offsetof(V, color)}}});
  return streams;
}

}  // namespace chandelier
