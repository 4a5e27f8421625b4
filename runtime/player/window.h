// SPDX-License-Identifier: Apache-2.0
// A plain window with a fly camera.
#pragma once

#include <memory>
#include <vector>

#include "player/live_scene.h"

namespace chandelier::player {

class Window {
 public:
  /// Throws std::runtime_error where there is no display.
  explicit Window(const Options& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What the Vulkan instance must have to show pictures here.
  std::vector<const char*> instance_extensions() const;
  /// Shows the scene until the window is closed, Esc is pressed, a signal asks to end, or the frames asked for are
  /// drawn; then says on stderr how many were. Draws when something changed, or always where frames are asked for. The
  /// camera flies through the scene, as it is at the start, in ten seconds. Throws.
  void run(LiveScene& live, const gpu::Device& device);

 private:
  struct Impl;
  class Screen;
  std::unique_ptr<Impl> impl_;
};

}  // namespace chandelier::player
