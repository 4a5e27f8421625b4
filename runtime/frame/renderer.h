// SPDX-License-Identifier: Apache-2.0
// Draws pictures of a pack with a recipe. This is what an embedding program includes.
#pragma once

#include <memory>

#include "frame/frame_stats.h"
#include "frame/picture.h"
#include "frame/render_settings.h"
#include "gpu/device.h"
#include "pack_file.h"

namespace chandelier {

class Renderer {
 public:
  /// Uploads the pack, which must outlive it: lights are selected by looking into it. Throws gpu::Error.
  Renderer(gpu::Device& device, const pack::File& pack);
  Renderer(gpu::Device& device, pack::File&& pack) = delete;
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Draws a tiny frame and makes room for a real one, so that the real one's time is its own.
  void warm_up(const RenderSettings& settings);
  /// Draws one frame and waits for it. Throws gpu::Error, std::invalid_argument where refusal() has a reason or what
  /// the recipe needs is missing in the settings.
  FrameStats draw(const RenderSettings& settings);
  /// The last frame drawn.
  Picture read_back();
  /// The last frame as shown: VK_FORMAT_R8G8B8A8_UNORM holding sRGB values, in TRANSFER_SRC_OPTIMAL.
  VkImage shown_image() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace chandelier
