// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "player/options.h"
#include "shading/edges.h"

namespace chandelier::player {
namespace {

constexpr std::chrono::milliseconds silent_for{500};

// One line that is written over, on a terminal alone, and only where the upload takes long enough to be asked about.
class UploadLine {
 public:
  explicit UploadLine(std::string pack) : pack_(std::move(pack)) {}

  void operator()(uint64_t done_bytes, uint64_t all_bytes) {
    const bool is_over = done_bytes >= all_bytes;
    if (isatty(STDERR_FILENO) == 0 || all_bytes == 0) return;
    if (!was_shown_ && (is_over || std::chrono::steady_clock::now() - start_ < silent_for)) return;
    was_shown_ = true;
    fmt::print(stderr, "\r{}: {} of {} MiB on the device{}", pack_, done_bytes >> 20, all_bytes >> 20,
               is_over ? "\n" : "");
  }

 private:
  std::string pack_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool was_shown_ = false;
};

}  // namespace

uint32_t default_samples(const gpu::Device& device, uint32_t width, uint32_t height) {
  constexpr uint32_t usual = 4;
  const bool is_chosen = !device.is_software && can_draw_samples(device, usual) &&  // shading/MEASUREMENTS.md
                         has_room_for_edges(device, width, height, usual);
  return is_chosen ? usual : 1;
}

RendererOptions renderer_options(const Options& options) {
  RendererOptions made;
  made.anisotropy = options.anisotropy;
  made.upload_progress = UploadLine(options.pack.filename().string());
  return made;
}

}  // namespace chandelier::player
