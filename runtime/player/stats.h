// SPDX-License-Identifier: Apache-2.0
// The costs and counters of a run, for --stats and for reports. schemas/stats.schema.json describes the JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frame/renderer.h"
#include "player/camera.h"

namespace chandelier::player {

/// Names of a light, and of the light whose shadow map it takes.
struct SharedMap {
  std::string light;
  std::string map_of;
};

/// One recipe drawn a number of times.
struct Run {
  std::string pack;  // file name, without folders
  std::string device;
  std::string driver;
  std::string preset;
  NamedCamera camera;
  RenderSettings settings;
  uint32_t frames = 0;
  FrameStats stats;      // medians of the times; counters of the last frame
  std::string image;     // the picture's file name; empty: none
  std::string radiance;  // the EXR's; empty: none
  std::optional<std::vector<SharedMap>> shared_maps;
  std::optional<double> expected_rmse;  // of the shown picture, told before it was drawn
};

struct Counter {
  std::string_view name;
  uint64_t FrameStats::*value;
  bool is_bytes;
  bool is_predicted = true;  // needs no device
};
/// Every counter of a frame, in the order of reports.
std::span<const Counter> counters();

/// Median of every time over `frames` (at least one), which were drawn with the same settings.
FrameStats medians(std::span<const FrameStats> frames);

nlohmann::ordered_json to_json(const Run& run);

/// Of a run that was predicted, not drawn.
nlohmann::ordered_json prediction_json(const Run& run);

}  // namespace chandelier::player
