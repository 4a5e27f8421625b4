// SPDX-License-Identifier: Apache-2.0
// chandelier-lights: which lights will share a shadow map, from JSON to JSON.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "preview/light_json.h"

namespace {

using namespace chandelier::preview;

constexpr int most_depth = 8;  // of objects and lists in each other

constexpr const char* footer = R"(Input, every part optional:
  {"lights": {"position": [[0, 2, 0], [0.2, 2, 0]],        metres; the other columns have as many values
              "type": ["point", "spot"],                   point, spot, directional [all point]
              "direction": [[0, -1, 0], [0, -1, 0]],       the way each shines; spot and directional lights need one
              "intensity": [50, 80],                       candela, or lux [1]
              "color": [[1, 1, 1], [1, 0.8, 0.6]],         linear [white]
              "range_m": [6, null],                        null: as chandelier-bake derives it [all null]
              "spot_outer_rad": [0, 0.6],                  half angle [0.7854]
              "radius_m": [0.1, 0],                        of what shines; a spot's softness adds cube faces [0]
              "dynamic": [false, true], "cluster": [true, true], "shadow": [true, true], "priority": [128, 200],
              "group": [-1, -1]},                          lights of the same number share one map [-1: of none]
   "settings": {"select": "light-clusters", "filter": "pcss", "d_init_m": 0.5, "z_far_m": 30, "distance_scaling": "grow",
                "dynamic_lights": "cluster", "face_size_px": 512, "reference_share": 0.85, "range_threshold_lx": 0.05,
                "max_shadow_maps": 0, "max_shadow_bytes": 0},          budgets; 0: none
   "camera": {"eye_ws": [0, 1.7, 5], "forward_ws": [0, 0, -1], "up_ws": [0, 1, 0], "yfov_rad": 0.9, "znear_m": 0.05,
              "size_px": [1280, 720]}}                     without forward_ws every light is in view

Output: center_of_light (null out of view and without shadow), range_of_light_m, over_budget (the lights that lose a
map of their own), clusters (center, light_count, d_min_m, range_m, spread_m) and bill (lights_in_view, shadow_maps,
shadow_views, shadow_bytes, d_init_m, ...). What needs geometry is not told: triangles, walls, selection by error.

Examples:
  chandelier-lights lights.json
  chandelier-lights < lights.json > selection.json
  echo '{"lights": {"position": [[0,0,0], [0.1,0,0], [9,0,0]]}}' | chandelier-lights

Exit status: 0 done, 1 failed, 2 wrong usage.)";

std::string reason() {
  return std::string(" (") + std::strerror(errno) + ")";
}

std::string read_all(const std::string& path) {
  std::ifstream file;
  if (path != "-") file.open(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot be opened" + reason());
  std::istream& in = path == "-" ? std::cin : file;
  std::ostringstream text;
  if (in.peek() != std::istream::traits_type::eof()) text << in.rdbuf();
  if (in.bad() || text.bad()) throw std::runtime_error("cannot be read" + reason());
  return std::move(text).str();
}

nlohmann::json parse(const std::string& text) {
  return nlohmann::json::parse(text, [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > most_depth) throw std::runtime_error("is nested too deeply (" + std::to_string(depth) + ")");
    return true;
  });
}

std::string selection_of(const std::string& text) {
  const Request request = read_request(parse(text));
  if (request.zero_ranges > 0)
    std::fprintf(
        stderr,
        "chandelier-lights: warning: lights.range_m: 0 is taken as none, so that the range is derived; null says "
        "so without a warning (%u of %u)\n",
        request.zero_ranges, request.lights.count);
  const uint32_t count = request.lights.count;
  std::vector<uint32_t> centers(count);
  std::vector<float> ranges(count);
  std::vector<uint8_t> over_budget(count);
  std::vector<ChandelierPreviewCluster> clusters(count);
  ChandelierPreviewResult result{.struct_bytes = sizeof result,
                                 .capacity = count,
                                 .center_of_light = centers.data(),
                                 .range_of_light_m = ranges.data(),
                                 .over_budget_of_light = over_budget.data(),
                                 .clusters = clusters.data()};
  char error[512];
  if (chandelier_preview_select(&request.lights, &request.settings, &request.camera, &result, error, sizeof error) !=
      CHANDELIER_PREVIEW_OK)
    throw std::runtime_error(error);
  return to_json(result, count).dump() + "\n";
}

bool put(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

/// One line, whatever the text has in it.
std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  std::string path = "-";
  CLI::App app("Tells which lights will share a shadow map, and what the maps take.", "chandelier-lights");
  app.footer(footer);
  app.set_version_flag("--version", CHANDELIER_VERSION);
  app.add_option("FILE", path, "JSON, - for standard input")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    if (put(selection_of(read_all(path)))) return 0;
    std::fprintf(stderr, "chandelier-lights: error: cannot write to standard output\n");
  } catch (const std::exception& error) {
    const std::string where = path == "-" ? "standard input" : path;
    std::fprintf(stderr, "chandelier-lights: error: %s\n", in_one_line(where + ": " + error.what()).c_str());
  }
  return 1;
}
