// SPDX-License-Identifier: Apache-2.0
// An open pack with its camera, and recipes that meet the budget for that camera.
#pragma once

#include <sys/stat.h>

#include <cstdint>

#include "player/camera.h"
#include "player/options.h"
#include "world/world.h"

namespace chandelier::player {

/// Identifies a file and its state by what the file system tells; all 0 if there is no file. The stamp changes when
/// another file is renamed over it, or when it is written to.
struct FileStamp {
  dev_t device = 0;
  ino_t inode = 0;
  off_t size_bytes = 0;
  int64_t changed_ns = 0;  // mtime

  bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::filesystem::path& path);

struct Scene {
  /// Opens asked.pack and meets the budget; the sides of a comparison do that when they are drawn. Prints warnings
  /// about lights and camera on stderr. Throws pack::Error, and std::runtime_error if the pack has no such camera.
  explicit Scene(const Options& asked);

  FileStamp stamp;  // from before the file was read
  pack::File pack;  // a copy if it is drawn: later writes into the file must have no effect after the check
  World world;      // of the pack
  Options options;  // with the headlight that the pack needs, and recipes that keep the budget
  NamedCamera camera;
};

}  // namespace chandelier::player
