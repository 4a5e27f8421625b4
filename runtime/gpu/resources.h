// SPDX-License-Identifier: Apache-2.0
// Buffers, images and samplers that free themselves, and the one-off commands that fill them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "gpu/allocator.h"
#include "gpu/device.h"

namespace chandelier::gpu {

/// A Vulkan handle with the call that destroys it.
template <typename Handle>
class Owned {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*);
  Owned() = default;
  Owned(VkDevice device, Handle handle, Destroy destroy) : device_(device), handle_(handle), destroy_(destroy) {}
  Owned(Owned&& o) noexcept
      : device_(o.device_), handle_(std::exchange(o.handle_, Handle{VK_NULL_HANDLE})), destroy_(o.destroy_) {}
  Owned& operator=(Owned&& o) noexcept {
    std::swap(device_, o.device_);
    std::swap(handle_, o.handle_);
    std::swap(destroy_, o.destroy_);
    return *this;
  }
  ~Owned() {
    if (handle_) destroy_(device_, handle_, nullptr);
  }
  operator Handle() const { return handle_; }  // NOLINT: stands for the handle in Vulkan calls
  const Handle* address() const { return &handle_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

/// The same, held by several: the last of them destroys it.
template <typename Handle>
class Shared {
 public:
  Shared() = default;
  Shared(Owned<Handle>&& owned) : owned_(std::make_shared<const Owned<Handle>>(std::move(owned))) {}
  operator Handle() const { return owned_ ? *owned_ : Handle{VK_NULL_HANDLE}; }  // NOLINT: as above

 private:
  std::shared_ptr<const Owned<Handle>> owned_;
};

// Members are destroyed from the last to the first: a buffer before its memory, a view before its image.
struct Buffer {
  Allocation memory;
  Owned<VkBuffer> handle;
  VkDeviceSize size_bytes = 0;
  std::byte* mapped = nullptr;  // coherent; null for Memory::device
};

/// At least one byte is made, so that an empty list still has something to bind.
Buffer make_buffer(const Device& device, VkDeviceSize size_bytes, VkBufferUsageFlags usage, Memory where);

struct ImageInfo {
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t width = 1;
  uint32_t height = 1;
  uint32_t levels = 1;
  uint32_t layers = 1;
  uint32_t samples = 1;
  VkImageUsageFlags usage = 0;
  VkImageCreateFlags flags = 0;
  VkImageViewType view_type = VK_IMAGE_VIEW_TYPE_2D;
};

struct Image {
  Allocation memory;
  Owned<VkImage> handle;
  Owned<VkImageView> view;  // all levels and layers
  ImageInfo info;
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
  VkDeviceSize size_bytes = 0;
};

Image make_image(const Device& device, const ImageInfo& info);
/// Whether a 2D image of this format and usage may have so many samples: 1, 2, 4, 8 …
bool can_have_samples(const Device& device, VkFormat format, VkImageUsageFlags usage, uint32_t samples);
/// Another view of layers [first_layer, first_layer + layer_count).
Owned<VkImageView> make_view(const Device& device, const Image& image, VkImageViewType type, uint32_t first_layer,
                             uint32_t layer_count);
Owned<VkSampler> make_sampler(const Device& device, const VkSamplerCreateInfo& info);
/// For shaders that read an image texel by texel.
Owned<VkSampler> make_texel_sampler(const Device& device);

/// Records commands, submits them and waits until they are done.
void run_once(const Device& device, const std::function<void(Commands)>& record);

/// Ends the commands, submits them and waits until they are done.
void submit_and_wait(const Device& device, VkCommandBuffer commands);

/// A new device buffer with these bytes.
Buffer upload_buffer(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage);

/// What `to` does after this waits for what `from` did before it, and sees what `from` wrote: buffers and images.
void memory_barrier(Commands cmd, VkPipelineStageFlags2 from_stage, VkAccessFlags2 from_access,
                    VkPipelineStageFlags2 to_stage, VkAccessFlags2 to_access);

struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags2 stage;
  VkAccessFlags2 access;
};
/// Moves a whole image from one use to the next.
void image_barrier(Commands cmd, const Image& image, const ImageUse& from, const ImageUse& to);
void image_barrier(Commands cmd, VkImage image, const ImageUse& from, const ImageUse& to,
                   VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT);

}  // namespace chandelier::gpu
