// SPDX-License-Identifier: Apache-2.0
// Two presets, one view.
#include "player/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include "player/budget.h"
#include "player/darkness.h"
#include "player/image_files.h"
#include "player/metrics/color_maps.h"
#include "player/metrics/flip.h"
#include "player/metrics/ssim.h"
#include "player/report.h"

namespace chandelier::player {
namespace {

constexpr uint32_t frames_unless_asked = 5;
constexpr uint32_t frames_beside_truth = 1;  // truth takes seconds per frame, and its time is not of interest

struct Side {
  NamedRecipe named;
  RenderSettings settings;
  std::vector<FrameStats> frames;
  Picture picture;
};

// Both sides draw in turns, so a slow moment of the machine affects both. What meets a budget depends on the exposure,
// so B is planned once A's exposure is known.
void draw_in_turns(Renderer& renderer, const pack::File& pack, const World& world, const Budget& budget,
                   uint32_t frames, Side& a, Side& b) {
  Predictor predictor(world);
  apply_budget(budget, a.named, a.settings, predictor, pack, world);
  renderer.warm_up(a.settings);
  for (uint32_t i = 0; i < frames; ++i) {
    a.frames.push_back(renderer.draw(a.settings));
    if (i + 1 == frames) a.picture = renderer.read_back();
    if (i == 0) {
      b.settings.exposure_ev = a.frames.front().exposure_ev;
      apply_budget(budget, b.named, b.settings, predictor, pack, world);
      renderer.warm_up(b.settings);
    }
    b.frames.push_back(renderer.draw(b.settings));
  }
  b.picture = renderer.read_back();
}

Run side_run(const Options& options, const NamedCamera& camera, const gpu::Device& device, const Side& side,
             size_t index) {
  Run run;
  run.pack = options.pack.filename().string();
  run.device = device.name;
  run.driver = device.driver;
  run.preset = side.named.preset;
  run.camera = camera;
  run.settings = side.settings;
  run.frames = static_cast<uint32_t>(side.frames.size());
  run.stats = medians(side.frames);
  run.shared_maps = side.named.shared_maps;
  run.expected_rmse = side.named.expected_rmse;
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

Differences differences(const Picture& a, const Picture& b, std::span<const float> flip) {
  if (a.width != b.width || a.height != b.height) throw std::invalid_argument("pictures of different sizes");
  const size_t pixels = size_t{a.width} * a.height;
  Differences result;
  for (size_t i = 0; i < 4 * pixels; ++i) {
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
  result.ssim = ssim(a, b);
  result.flip = std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(pixels);
  return result;
}

std::vector<float> shown_differences(const Picture& a, const Picture& b) {
  std::vector<float> values(size_t{a.width} * a.height);
  for (size_t i = 0; i < values.size(); ++i) {
    int largest = 0;
    for (size_t c = 4 * i; c < 4 * i + 3; ++c) largest = std::max(largest, std::abs(a.shown[c] - b.shown[c]));
    values[i] = static_cast<float>(largest) / 255.0f;
  }
  return values;
}

float heat_scale(std::vector<float> values) {
  if (values.empty()) return 1.0f / 255.0f;
  const auto rank = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) * 999 / 1000);
  std::nth_element(values.begin(), rank, values.end());
  if (*rank > 0.0f) return *rank;
  const float largest = *std::max_element(rank, values.end());
  return largest > 0.0f ? largest : 1.0f / 255.0f;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
  const Differences& d = comparison.differences;
  return {{"a", to_json(comparison.a)},
          {"b", to_json(comparison.b)},
          {"rmse", {{"linear", d.rmse_linear}, {"shown", d.rmse_shown}}},
          {"max_error", {{"linear", d.max_linear}, {"shown", d.max_shown}}},
          {"ssim", d.ssim ? nlohmann::ordered_json(*d.ssim) : nlohmann::ordered_json()},
          {"flip", {{"mean", d.flip}, {"image", comparison.flip_image}, {"pixels_per_degree", flip_pixels_per_degree}}},
          {"difference", {{"image", comparison.difference_image}, {"scale_shown", comparison.heat_scale}}}};
}

void run_comparison(const Options& options, const NamedCamera& camera, const pack::File& pack, const World& world,
                    const gpu::Device& device, Renderer& renderer, const VisibilitySource& visibility) {
  make_folder(options.report);
  Side a{.named = options.recipes[0]};
  Side b{.named = options.recipes[1]};
  a.settings = render_settings(options, a.named.recipe, camera.camera, visibility);
  b.settings = render_settings(options, b.named.recipe, camera.camera, visibility);
  const bool truth = std::any_of(options.recipes.begin(), options.recipes.end(), traces_rays);
  draw_in_turns(renderer, pack, world, options.budget,
                options.frames.value_or(truth ? frames_beside_truth : frames_unless_asked), a, b);

  Comparison comparison;
  comparison.a = side_run(options, camera, device, a, 0);
  comparison.b = side_run(options, camera, device, b, 1);
  const std::vector<float> flip = flip_map(a.picture, b.picture);
  comparison.differences = differences(a.picture, b.picture, flip);
  comparison.flip_image = "flip.png";
  comparison.difference_image = "difference.png";
  const std::vector<float> values = shown_differences(a.picture, b.picture);
  comparison.heat_scale = heat_scale(values);

  write_side(options.report, comparison.a, a.picture);
  write_side(options.report, comparison.b, b.picture);
  write_png(options.report / comparison.difference_image, a.picture.width, a.picture.height,
            colored(values, comparison.heat_scale, heat_color));
  write_png(options.report / comparison.flip_image, a.picture.width, a.picture.height,
            colored(flip, 1.0f, magma_color));
  write_file(options.report / "comparison.json", to_json(comparison).dump(2) + "\n");
  write_file(options.report / "report.html", report_html(comparison));
  warn_of_black(options, pack.view(), a.picture);
  const Differences& d = comparison.differences;
  fmt::print(stderr,
             "{}: RMSE {:.5f} shown, {:.5f} linear; SSIM {}; FLIP {:.5f}; {:.1f} and {:.1f} ms (medians of {}) on {}\n",
             (options.report / "report.html").string(), d.rmse_shown, d.rmse_linear,
             d.ssim ? fmt::format("{:.5f}", *d.ssim) : "none", d.flip, comparison.a.stats.frame_ms,
             comparison.b.stats.frame_ms, comparison.a.frames, comparison.a.device);
}

}  // namespace chandelier::player
