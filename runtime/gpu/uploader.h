// SPDX-License-Identifier: Apache-2.0
// Fills a scene's buffers and images: many copies, one submit.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "gpu/resources.h"

namespace chandelier::gpu {

/// Called with bytes copied so far and with all that will be.
using UploadProgress = std::function<void(uint64_t done_bytes, uint64_t all_bytes)>;

class Uploader {
 public:
  /// `all_bytes` is for `progress` alone, which may be empty.
  Uploader(const Device& device, uint64_t all_bytes, UploadProgress progress);
  ~Uploader();
  Uploader(const Uploader&) = delete;
  Uploader& operator=(const Uploader&) = delete;

  /// A new device buffer that holds these bytes once finish() has returned. Throws Error.
  Buffer buffer(std::span<const std::byte> bytes, VkBufferUsageFlags usage);
  /// Fills an image that is new; `copies` count from the start of `bytes`. Fragment shaders may sample it after
  /// finish().
  void image(const Image& to, std::span<const std::byte> bytes, std::span<const VkBufferImageCopy> copies);
  /// Submits what is left and waits for it. Throws Error.
  void finish();

 private:
  Commands commands();
  std::span<std::byte> stage(VkDeviceSize bytes);
  void flush();

  const Device& device_;
  uint64_t all_bytes_;
  UploadProgress progress_;
  uint64_t done_bytes_ = 0;
  uint64_t staged_bytes_ = 0;
  std::vector<Buffer> staging_;
  VkCommandBuffer handle_ = VK_NULL_HANDLE;
};

}  // namespace chandelier::gpu
