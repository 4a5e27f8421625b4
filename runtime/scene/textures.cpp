// SPDX-License-Identifier: Apache-2.0
#include "scene/textures.h"

#include <volk.h>

#include <algorithm>
#include <array>

#include "image_format.h"
#include "pack_images.h"
#include "shaders/g_buffer_frag.h"

namespace chandelier {
namespace {

VkFormat format_of(pack::ImageFormat format) {
  switch (format) {
    case pack::ImageFormat::rgba8_srgb:
      return VK_FORMAT_R8G8B8A8_SRGB;
    case pack::ImageFormat::rgba8_unorm:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case pack::ImageFormat::bc1_srgb:
      return VK_FORMAT_BC1_RGB_SRGB_BLOCK;
    case pack::ImageFormat::bc1_unorm:
      return VK_FORMAT_BC1_RGB_UNORM_BLOCK;
    case pack::ImageFormat::bc3_srgb:
      return VK_FORMAT_BC3_SRGB_BLOCK;
    case pack::ImageFormat::bc5_unorm:
      return VK_FORMAT_BC5_UNORM_BLOCK;
    case pack::ImageFormat::rgba16_sfloat:
      return VK_FORMAT_R16G16B16A16_SFLOAT;  // every Vulkan device samples it, linearly too
  }
  pack::refuse_format(format);
}

std::vector<VkBufferImageCopy> copies_of_levels(const pack::Image& info) {
  std::vector<VkBufferImageCopy> copies;
  VkDeviceSize offset = 0;
  for (uint32_t i = 0; i < info.level_count; ++i) {
    const pack::ImageLevel level = pack::level_of(info, i);
    copies.push_back({.bufferOffset = offset,
                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, i, 0, 1},
                      .imageExtent = {level.width, level.height, 1}});
    offset += level.bytes;
  }
  return copies;
}

// How many to decode together: at least one, and else no more than this in all.
uint32_t images_at_once(std::span<const pack::Image> images) {
  constexpr uint64_t most_bytes = uint64_t{64} << 20;
  uint64_t bytes = 0;
  for (uint32_t i = 0; i < images.size(); ++i) {
    bytes += images[i].size_bytes;
    if (bytes > most_bytes) return std::max(1u, i);
  }
  return static_cast<uint32_t>(images.size());
}

gpu::Image upload_image(const gpu::Device& device, gpu::Uploader& uploader, const pack::Image& info,
                        std::span<const std::byte> texels) {
  if (std::max(info.width, info.height) > device.limits.maxImageDimension2D)
    throw gpu::Error("an image of " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                     " texels is too large for this device");
  if (pack::block_of(info.format).side_texels > 1 && !device.samples_bc)
    throw gpu::Error("this device has no BC textures: bake with --textures raw");
  gpu::Image image = gpu::make_image(device, {.format = format_of(info.format),
                                              .width = info.width,
                                              .height = info.height,
                                              .levels = info.level_count,
                                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  uploader.image(image, texels, copies_of_levels(info));
  return image;
}

VkSamplerAddressMode address_mode(pack::Wrap wrap) {
  switch (wrap) {
    case pack::Wrap::clamp_to_edge:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case pack::Wrap::mirrored_repeat:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    default:
      return VK_SAMPLER_ADDRESS_MODE_REPEAT;
  }
}

// One sampler per combination of wraps and filters; 3 * 3 * 2 * 2 of them.
uint32_t sampler_number(const pack::Texture& t) {
  const auto number = [](auto value) { return static_cast<uint32_t>(value); };
  return ((number(t.wrap_u) * 3 + number(t.wrap_v)) * 2 + number(t.mag_filter)) * 2 + number(t.min_filter);
}

std::vector<gpu::Owned<VkSampler>> make_samplers(const gpu::Device& device, float anisotropy) {
  const float most = device.samples_anisotropic ? std::min(anisotropy, device.limits.maxSamplerAnisotropy) : 1.0f;
  std::vector<gpu::Owned<VkSampler>> samplers;
  for (uint32_t i = 0; i < 36; ++i) {
    const bool min_linear = i % 2 == 1;
    const bool mag_linear = i / 2 % 2 == 1;
    const bool is_anisotropic = min_linear && mag_linear && most > 1.0f;
    samplers.push_back(gpu::make_sampler(
        device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                 .magFilter = mag_linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST,
                 .minFilter = min_linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST,
                 .mipmapMode = min_linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST,
                 .addressModeU = address_mode(static_cast<pack::Wrap>(i / 12)),
                 .addressModeV = address_mode(static_cast<pack::Wrap>(i / 4 % 3)),
                 .addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT,
                 .anisotropyEnable = is_anisotropic,
                 .maxAnisotropy = is_anisotropic ? most : 1.0f,
                 .maxLod = VK_LOD_CLAMP_NONE}));
  }
  return samplers;
}

// Texture slots in the pack's order, and the samplers of shading/material.glsl that read them.
struct TextureSlot {
  std::string_view sampler;
  uint32_t pack::Material::*texture;
};
constexpr std::array<TextureSlot, 5> texture_slots{
    {{"base_color_map", &pack::Material::base_color_texture},
     {"metallic_roughness_map", &pack::Material::metallic_roughness_texture},
     {"normal_map", &pack::Material::normal_texture},
     {"occlusion_map", &pack::Material::occlusion_texture},
     {"emissive_map", &pack::Material::emissive_texture}}};
constexpr auto textures_per_material = static_cast<uint32_t>(texture_slots.size());

// Where the shaders have a slot's sampler.
uint32_t binding_of(const TextureSlot& slot) {
  for (const gpu::Binding& binding : g_buffer_frag_bindings)
    if (binding.set == 1 && binding.name == slot.sampler) return binding.number;
  throw gpu::Error("g_buffer_frag: " + std::string(slot.sampler) + ": there is no such binding");
}

void make_material_layout(const gpu::Device& device, uint32_t materials, GpuScene& scene) {
  std::array<VkDescriptorSetLayoutBinding, textures_per_material> bindings{};
  for (uint32_t i = 0; i < textures_per_material; ++i)
    bindings[i] = {.binding = binding_of(texture_slots[i]),
                   .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                   .descriptorCount = 1,
                   .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT};
  const VkDescriptorSetLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                    .bindingCount = textures_per_material,
                                                    .pBindings = bindings.data()};
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  gpu::check(device->vkCreateDescriptorSetLayout(device.handle, &layout_info, nullptr, &layout),
             "vkCreateDescriptorSetLayout");
  scene.material_layout = {device.handle, layout, device->vkDestroyDescriptorSetLayout};

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                  std::max(1u, materials) * textures_per_material};
  const VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = std::max(1u, materials),
                                             .poolSizeCount = 1,
                                             .pPoolSizes = &size};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  gpu::check(device->vkCreateDescriptorPool(device.handle, &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  scene.material_pool = {device.handle, pool, device->vkDestroyDescriptorPool};
}

// A texture that is absent is white: a driver may read a descriptor on a branch that is not taken.
VkDescriptorImageInfo describe(const pack::View& pack, const GpuScene& scene, uint32_t texture) {
  const bool absent = texture == pack::none;
  const gpu::Image& image = absent ? scene.images.back() : scene.images[pack.textures[texture].image];
  const uint32_t sampler = absent ? 0 : sampler_number(pack.textures[texture]);
  return {scene.samplers[sampler], image.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}

VkDescriptorSet make_material_set(const gpu::Device& device, const pack::View& pack, const GpuScene& scene,
                                  const pack::Material& material) {
  const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .descriptorPool = scene.material_pool,
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = scene.material_layout.address()};
  VkDescriptorSet set = VK_NULL_HANDLE;
  gpu::check(device->vkAllocateDescriptorSets(device.handle, &info, &set), "vkAllocateDescriptorSets");
  for (const TextureSlot& slot : texture_slots) {
    const VkDescriptorImageInfo image = describe(pack, scene, material.*slot.texture);
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .dstBinding = binding_of(slot),
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                     .pImageInfo = &image};
    device->vkUpdateDescriptorSets(device.handle, 1, &write, 0, nullptr);
  }
  return set;
}

}  // namespace

std::vector<glm::vec3> uv_rows(const pack::View& pack) {
  std::vector<glm::vec3> rows;
  for (const pack::Material& material : pack.materials) {
    for (const TextureSlot& slot : texture_slots) {
      const uint32_t texture = material.*slot.texture;
      const bool absent = texture == pack::none;
      rows.push_back(absent ? glm::vec3(1, 0, 0) : pack.textures[texture].uv_transform[0]);
      rows.push_back(absent ? glm::vec3(0, 1, 0) : pack.textures[texture].uv_transform[1]);
    }
  }
  return rows;
}

void upload_textures(const gpu::Device& device, gpu::Uploader& uploader, const pack::View& pack, float anisotropy,
                     GpuScene& scene) {
  const auto image_count = static_cast<uint32_t>(pack.images.size());
  for (uint32_t first = 0; first < image_count;) {
    const uint32_t count = images_at_once(pack.images.subspan(first));
    const std::vector<pack::Texels> texels = pack::texels_of(pack, first, count);
    for (uint32_t i = 0; i < count; ++i)
      scene.images.push_back(upload_image(device, uploader, pack.images[first + i], texels[i].bytes()));
    first += count;
  }
  const std::array<std::byte, 4> white{std::byte{255}, std::byte{255}, std::byte{255}, std::byte{255}};
  scene.images.push_back(upload_image(
      device, uploader, {.width = 1, .height = 1, .level_count = 1, .format = pack::ImageFormat::rgba8_unorm}, white));
  scene.samplers = make_samplers(device, anisotropy);
  make_material_layout(device, static_cast<uint32_t>(pack.materials.size()), scene);
  for (const pack::Material& material : pack.materials)
    scene.material_sets.push_back(make_material_set(device, pack, scene, material));
}

}  // namespace chandelier
