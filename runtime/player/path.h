// SPDX-License-Identifier: Apache-2.0
// A camera moves along a recorded path: measures what changes from frame to frame beside the camera's own motion.
// schemas/path.schema.json describes the JSON that is written.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "player/options.h"

namespace chandelier::player {

/// One step of the camera.
struct PathStep {
  uint64_t shadow_maps = 0;
  uint64_t lights_in_view = 0;
  uint64_t lights_kept_in_view = 0;  // of them, also a frame ago; 0 in the first frame
  uint64_t lights_changed = 0;       // of those, that took another light's map than a frame ago
  /// RMSE of the shown picture against the same view with every light held at its centre of the frame before: the
  /// change that the selection causes, not the camera's motion. Lights that come into view or leave it do not count.
  double unexplained_rmse = 0.0;
};

/// `frames` cameras evenly along a path file: {"keys": ["ex,ey,ez,tx,ty,tz,fov_deg", …]}, at least two, in the world
/// of a pack with this origin. Throws std::runtime_error, one line.
std::vector<Camera> read_path(const std::filesystem::path& file, uint32_t frames, const glm::dvec3& origin_m);
/// The same from keys. Eye, direction and angle go evenly from key to key.
std::vector<Camera> cameras_along(const std::vector<Camera>& keys, uint32_t frames);

/// The number of lights that have a centre in both lists, and how many of these have a different one.
struct CenterChanges {
  uint64_t kept_in_view = 0;
  uint64_t changed = 0;
};
CenterChanges center_changes(std::span<const uint32_t> before, std::span<const uint32_t> after);

/// Draws every step and writes path.json and last.png into the report's folder. Throws.
void run_path(const Options& options, const pack::File& pack, const gpu::Device& device, Renderer& renderer,
              const VisibilitySource& visibility);

}  // namespace chandelier::player
