// SPDX-License-Identifier: Apache-2.0
// A scene on the device that follows its file: a pack that replaces the file is shown.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "player/scene.h"

namespace chandelier::player {

class LiveScene {
 public:
  /// `scene` was opened with `asked`. Throws gpu::Error.
  LiveScene(const Options& asked, std::unique_ptr<const Scene> scene, gpu::Device& device);

  /// Checks the file twice per second. If another pack has taken its place and is no longer being written, shows that
  /// one, with the settings' camera and size. A camera that was not moved follows the pack's camera. If the new pack
  /// cannot be shown, the older one stays, with a warning on stderr. Returns true if the last picture is out of date.
  /// Throws gpu::Error if not even the older pack can be shown again.
  bool follow();

  /// Switches the headlight on or off; it stays so when the pack is replaced.
  void toggle_headlight();

  const Scene& scene() const { return *scene_; }
  Renderer& renderer() { return on_device_->renderer; }
  /// True if the file's present content cannot be shown, and this is the older one.
  bool is_older() const { return is_older_; }

  RenderSettings settings;  // of the next frame; camera, size and previous centres are the caller's to change

 private:
  struct OnDevice {
    VisibilitySource visibility;
    Renderer renderer;
  };

  void replace();
  RenderSettings put_on_device(const Scene& scene);

  Options asked_;
  gpu::Device& device_;
  std::unique_ptr<const Scene> scene_;
  Camera pack_camera_;              // as last taken from a pack
  std::optional<float> headlight_;  // as last toggled
  std::optional<OnDevice> on_device_;
  std::chrono::steady_clock::time_point next_look_;
  FileStamp seen_;   // at the last look
  FileStamp tried_;  // shown, or found not to be a pack
  bool is_older_ = false;
};

}  // namespace chandelier::player
