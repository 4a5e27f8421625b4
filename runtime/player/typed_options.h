// SPDX-License-Identifier: Apache-2.0
// The command line of chandelier-play as it is typed, before its arguments are checked against each other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace chandelier::player {

constexpr uint32_t largest_picture = 16384;  // texels a side; no Vulkan device draws more

struct Typed {
  std::string pack, output, size = "1280x720", camera, stats, device, preset, exposure = "auto", headlight = "auto",
                            anisotropy = "auto", ambient = "0", samples = "auto", compare, report, path;
  std::optional<uint32_t> frames;
  bool list_devices = false;
  bool predict = false;
  bool validation = false;
  bool keep_shadow_maps = false;
  std::vector<std::string> answers;   // one per stage; empty where not given
  std::vector<std::string> settings;  // one of recipe_settings() each; empty where not given
  std::optional<float> max_error;
  std::optional<uint32_t> max_shadow_maps, max_shadow_bytes;
};

std::vector<std::string> preset_names();

/// Declares every option, with its help and the values that it takes alone; what is typed lands in `typed`.
void declare_options(CLI::App& app, Typed& typed);

}  // namespace chandelier::player
