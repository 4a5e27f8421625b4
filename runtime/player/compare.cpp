// SPDX-License-Identifier: Apache-2.0
// Two presets, one view.
#include "player/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "player/image_files.h"
#include "player/report.h"

namespace chandelier::player {
namespace {

constexpr uint32_t kFramesUnlessAsked = 5;

struct Side {
  RenderSettings settings;
  std::vector<FrameStats> frames;
  Picture picture;
};

// Where the machine slows down for a while, both sides get their share of it.
void draw_in_turns(Renderer& renderer, uint32_t frames, Side& a, Side& b) {
  renderer.warm_up(a.settings);
  renderer.warm_up(b.settings);
  for (uint32_t i = 0; i < frames; ++i) {
    a.frames.push_back(renderer.draw(a.settings));
    if (i + 1 == frames) a.picture = renderer.read_back();
    b.settings.exposure_ev = a.frames.front().exposure_ev;
    b.frames.push_back(renderer.draw(b.settings));
  }
  b.picture = renderer.read_back();
}

std::vector<uint8_t> heat_map(std::span<const float> values, float scale) {
  std::vector<uint8_t> rgb;
  rgb.reserve(values.size() * 3);
  for (const float value : values) {
    const auto color = heat_color(value / scale);
    rgb.insert(rgb.end(), color.begin(), color.end());
  }
  return rgb;
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error(fmt::format("{}: cannot make the folder ({})", folder.string(),
                                         error ? error.message() : "something else is there"));
}

Run side_run(const Options& options, const NamedCamera& camera, const gpu::Device& device, const Side& side,
             std::size_t index) {
  Run run;
  run.pack = options.pack.filename().string();
  run.device = device.name;
  run.driver = device.driver;
  run.preset = options.recipes[index].preset;
  run.camera = camera;
  run.settings = side.settings;
  run.frames = static_cast<uint32_t>(side.frames.size());
  run.stats = medians(side.frames);
  const bool same = options.recipes[0].preset == options.recipes[1].preset;
  const std::string stem = same ? fmt::format("{}_{}", run.preset, index == 0 ? 'a' : 'b') : run.preset;
  run.image = stem + ".png";
  if (image_kind("x.exr")) run.radiance = stem + ".exr";
  return run;
}

void write_side(const std::filesystem::path& folder, const Run& run, const Picture& picture) {
  write_picture(folder / run.image, picture);
  if (!run.radiance.empty()) write_picture(folder / run.radiance, picture);
}

}  // namespace

Differences differences(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height) throw std::invalid_argument("pictures of different sizes");
  const std::size_t pixels = std::size_t{a.width} * a.height;
  Differences result;
  for (std::size_t i = 0; i < 4 * pixels; ++i) {
    if (i % 4 == 3) continue;
    const double linear = std::abs(double{a.radiance[i]} - double{b.radiance[i]});
    const double shown = std::abs(a.shown[i] - b.shown[i]) / 255.0;
    result.rmse_linear += linear * linear;
    result.rmse_shown += shown * shown;
    result.max_linear = std::max(result.max_linear, linear);
    result.max_shown = std::max(result.max_shown, shown);
  }
  const double samples = 3.0 * static_cast<double>(pixels);
  result.rmse_linear = std::sqrt(result.rmse_linear / samples);
  result.rmse_shown = std::sqrt(result.rmse_shown / samples);
  return result;
}

std::vector<float> shown_differences(const Picture& a, const Picture& b) {
  std::vector<float> values(std::size_t{a.width} * a.height);
  for (std::size_t i = 0; i < values.size(); ++i) {
    int largest = 0;
    for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) largest = std::max(largest, std::abs(a.shown[c] - b.shown[c]));
    values[i] = static_cast<float>(largest) / 255.0f;
  }
  return values;
}

float heat_scale(std::vector<float> values) {
  if (values.empty()) return 1.0f / 255.0f;
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 999 / 1000);
  std::nth_element(values.begin(), rank, values.end());
  if (*rank > 0.0f) return *rank;
  const float largest = *std::max_element(rank, values.end());
  return largest > 0.0f ? largest : 1.0f / 255.0f;
}

std::array<uint8_t, 3> heat_color(float t) {
  static constexpr std::array<std::array<float, 3>, 5> kStops{
      {{0, 0, 90}, {0, 60, 200}, {0, 220, 255}, {255, 230, 0}, {255, 0, 0}}};
  const float at = std::clamp(t, 0.0f, 1.0f) * (kStops.size() - 1);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(at), kStops.size() - 2);
  const float part = at - static_cast<float>(i);
  std::array<uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<uint8_t>(std::lround(kStops[i][c] + part * (kStops[i + 1][c] - kStops[i][c])));
  return color;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
  const Differences& d = comparison.differences;
  return {{"a", to_json(comparison.a)},
          {"b", to_json(comparison.b)},
          {"rmse", {{"linear", d.rmse_linear}, {"shown", d.rmse_shown}}},
          {"max_error", {{"linear", d.max_linear}, {"shown", d.max_shown}}},
          {"difference", {{"image", comparison.difference_image}, {"scale_shown", comparison.heat_scale}}}};
}

void run_comparison(const Options& options, const NamedCamera& camera, const gpu::Device& device, Renderer& renderer) {
  make_folder(options.report);
  Side a;
  Side b;
  a.settings = render_settings(options, options.recipes[0].recipe, camera.camera);
  b.settings = render_settings(options, options.recipes[1].recipe, camera.camera);
  draw_in_turns(renderer, options.frames.value_or(kFramesUnlessAsked), a, b);

  Comparison comparison;
  comparison.a = side_run(options, camera, device, a, 0);
  comparison.b = side_run(options, camera, device, b, 1);
  comparison.differences = differences(a.picture, b.picture);
  comparison.difference_image = "difference.png";
  const std::vector<float> values = shown_differences(a.picture, b.picture);
  comparison.heat_scale = heat_scale(values);

  write_side(options.report, comparison.a, a.picture);
  write_side(options.report, comparison.b, b.picture);
  write_png(options.report / comparison.difference_image, a.picture.width, a.picture.height,
            heat_map(values, comparison.heat_scale));
  write_file(options.report / "comparison.json", to_json(comparison).dump(2) + "\n");
  write_file(options.report / "report.html", report_html(comparison));
  fmt::print(stderr, "{}: RMSE {:.5f} shown, {:.5f} linear; {:.1f} and {:.1f} ms (medians of {}) on {}\n",
             (options.report / "report.html").string(), comparison.differences.rmse_shown,
             comparison.differences.rmse_linear, comparison.a.stats.frame_ms, comparison.b.stats.frame_ms,
             comparison.a.frames, comparison.a.device);
}

}  // namespace chandelier::player
