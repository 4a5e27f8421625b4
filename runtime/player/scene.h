// SPDX-License-Identifier: Apache-2.0
// A pack that was opened to be looked at: through which camera, and with recipes that keep the budget there.
#pragma once

#include <sys/stat.h>

#include <cstdint>

#include "player/camera.h"
#include "player/options.h"
#include "world/world.h"

namespace chandelier::player {

/// Which file a path leads to and how it was left, so far as the file system tells; all 0 where there is none. Another
/// one renamed over it, or written into it, is another stamp.
struct FileStamp {
  dev_t device = 0;
  ino_t inode = 0;
  off_t size_bytes = 0;
  int64_t changed_ns = 0;  // mtime

  bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::filesystem::path& path);

struct Scene {
  /// Opens asked.pack and keeps the budget, but for a comparison, whose sides keep it as they are drawn. Says on stderr
  /// what one should know of lights and camera. Throws pack::Error, and std::runtime_error where the pack has no such
  /// camera.
  explicit Scene(const Options& asked);

  FileStamp stamp;  // from before the file was read
  pack::File pack;  // a copy where it is drawn: what is written into the file after it was checked must not be seen
  World world;      // of the pack
  Options options;  // with the headlight that the pack needs, and recipes that keep the budget
  NamedCamera camera;
};

}  // namespace chandelier::player
