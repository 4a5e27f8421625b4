// SPDX-License-Identifier: Apache-2.0
// A scene on the device that follows its file: whatever replaces the pack is shown in its place.
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

  /// Looks at the file twice a second. A pack that has taken the shown one's place and is not being written any more
  /// is shown from now on, with the settings' camera and size; a camera that is still as the pack had it follows the
  /// pack's. One that cannot be shown leaves the older one and a warning on stderr. True where anything of that
  /// happened: what was drawn before is out of date. Throws gpu::Error where not even the
  /// older one can be shown again.
  bool follow();

  /// On where it is off; stays so when the pack is replaced.
  void toggle_headlight();

  const Scene& scene() const { return *scene_; }
  Renderer& renderer() { return on_device_->renderer; }
  /// What the file holds cannot be shown: this is what it held before.
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
