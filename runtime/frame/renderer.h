// SPDX-License-Identifier: Apache-2.0
// Draws pictures of a world with a recipe. This is what an embedding program includes.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "frame/frame_stats.h"
#include "frame/picture.h"
#include "frame/render_settings.h"
#include "gpu/device.h"
#include "world/world.h"

namespace chandelier {

struct RendererOptions {
  uint32_t frames_in_flight = 2;    // slots: frames that may be recorded before the first of them has finished
  std::optional<float> anisotropy;  // of textures, 1 to 16; absent: 8 on a GPU, 1 where the CPU draws
  std::function<void(uint64_t done_bytes, uint64_t all_bytes)> upload_progress;  // while the constructor uploads
};

/// An image of the caller's that a recorded frame is scaled to, all of it. Its old contents are lost.
struct Target {
  VkImage image = VK_NULL_HANDLE;  // with VK_IMAGE_USAGE_TRANSFER_DST_BIT; null: only shown_image() is drawn
  VkExtent2D size{};
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
};

class Renderer {
 public:
  /// Uploads the world as it is. It must outlive this; what changes in it between frames is in the next one that is
  /// recorded. Throws gpu::Error.
  Renderer(gpu::Device& device, const World& world, const RendererOptions& options = {});
  Renderer(gpu::Device& device, World&& world, const RendererOptions& options = {}) = delete;
  /// No recorded frame may be on its way.
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Records one frame into a command buffer that is being recorded, outside of a render pass, and submits nothing.
  /// Frames must be submitted in the order in which they were recorded, to the device's queue. `slot` is less than
  /// frames_in_flight (else std::out_of_range), and the commands that were recorded with it before have finished.
  /// Throws gpu::Error, and std::invalid_argument where refusal() has a reason or the recipe needs rays, which only
  /// draw() casts. Returns what is known already: all but times, exposure, draws and triangles.
  const FrameStats& record(VkCommandBuffer cmd, uint32_t slot, const RenderSettings& settings,
                           const Target& target = {});
  /// Records a copy of the last frame drawn or recorded. Throws std::logic_error where there is none.
  void record_again(VkCommandBuffer cmd, const Target& target);
  /// Of the frame that was last recorded with this slot, whose commands have finished: does not wait. frame_ms is the
  /// time of record() and of the device together.
  const FrameStats& stats(uint32_t slot);

  /// Draws a tiny frame and makes room for a real one, so that the real one's time is its own.
  void warm_up(const RenderSettings& settings);
  /// Draws one frame with slot 0 and waits for it. No recorded frame may be on its way. Throws as record() does, and
  /// std::invalid_argument where what the recipe needs is missing in the settings.
  FrameStats draw(const RenderSettings& settings);
  /// With RenderSettings::search_beside_frames: a search has ended since the last frame, whose selection was
  /// provisional; the next one may look different.
  bool has_new_selection() const;
  /// The last frame drawn, which must have been submitted; waits for it. Throws std::logic_error where there is none.
  Picture read_back();
  /// The last frame as shown: VK_FORMAT_R8G8B8A8_UNORM holding sRGB values, in TRANSFER_SRC_OPTIMAL.
  VkImage shown_image() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace chandelier
