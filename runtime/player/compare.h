// SPDX-License-Identifier: Apache-2.0
// Two presets, one view: pictures, their difference and what each cost. schemas/comparison.schema.json describes the
// JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "player/options.h"
#include "player/stats.h"

namespace chandelier::player {

/// Linear: radiance before exposure and tone map. Shown: sRGB values as on a screen, 0..1.
struct Differences {
  double rmse_linear = 0.0;
  double rmse_shown = 0.0;
  double max_linear = 0.0;
  double max_shown = 0.0;
  std::optional<double> ssim;  // absent where the picture is smaller than its window
  double flip = 0.0;           // mean over the pixels
};

struct Comparison {
  Run a;
  Run b;
  Differences differences;
  std::string difference_image;
  float heat_scale = 0.0f;  // the shown difference that is drawn red
  std::string flip_image;
};

/// RMSE and largest error are over R, G and B of every pixel. `flip` is flip_map() of the two pictures; its mean is
/// stored. Both have the same size.
Differences differences(const Picture& a, const Picture& b, std::span<const float> flip);
/// Per pixel: the largest difference of a shown channel, 0..1.
std::vector<float> shown_differences(const Picture& a, const Picture& b);
/// The value that 99.9 % of `values` do not exceed, so that a few stray pixels do not darken the map. If it is 0, the
/// largest value; if all are 0, 1/255.
float heat_scale(std::vector<float> values);
nlohmann::ordered_json to_json(const Comparison& comparison);

/// Draws both recipes in turns, within the budget, and writes pictures, difference.png, flip.png, comparison.json and
/// report.html. Throws.
void run_comparison(const Options& options, const NamedCamera& camera, const pack::File& pack, const World& world,
                    const gpu::Device& device, Renderer& renderer, const VisibilitySource& visibility);

}  // namespace chandelier::player
