// SPDX-License-Identifier: Apache-2.0
#include "frame/picture.h"

#include <volk.h>

#include <cstring>

namespace chandelier {

Picture read_picture(const gpu::Device& device, const Targets& targets) {
  Picture picture{.width = targets.width, .height = targets.height};
  const size_t pixels = size_t{targets.width} * targets.height;
  const gpu::Buffer buffer =
      gpu::make_buffer(device, pixels * 20, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  gpu::run_once(device, [&](gpu::Commands cmd) {
    VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                           .imageExtent = {targets.width, targets.height, 1}};
    gpu::image_barrier(cmd, targets.radiance, use::storage, use::copied);
    cmd->vkCmdCopyImageToBuffer(cmd, targets.radiance.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle, 1,
                                &copy);
    gpu::image_barrier(cmd, targets.radiance, use::copied, use::storage);
    copy.bufferOffset = pixels * 16;  // behind, because an offset must be a multiple of the texel's size
    cmd->vkCmdCopyImageToBuffer(cmd, targets.shown.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle, 1,
                                &copy);
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
  });
  picture.shown.resize(pixels * 4);
  picture.radiance.resize(pixels * 4);
  std::memcpy(picture.radiance.data(), buffer.mapped, pixels * 16);
  std::memcpy(picture.shown.data(), buffer.mapped + pixels * 16, pixels * 4);
  return picture;
}

}  // namespace chandelier
