// SPDX-License-Identifier: Apache-2.0
// The player's metrics give what public implementations of them give for the same pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "player/compare.h"
#include "player/metrics/color_maps.h"
#include "player/metrics/flip.h"
#include "player/metrics/ssim.h"

namespace chandelier::player {
namespace {

constexpr int width = 64, height = 48;

// A channel's value at x, y; integers only, so that any program can make the same picture.
using Formula = std::function<int(int x, int y, int channel)>;

int scene(int x, int y, int channel) {
  x = std::clamp(x, 0, width - 1);
  y = std::clamp(y, 0, height - 1);
  const int slope = channel == 0 ? 2 * x + 20 : channel == 1 ? 4 * y : 200 - x - y;
  const int checks = (x / 9 + y / 7) % 2 == 1 ? 50 - 25 * channel : 0;
  return std::clamp(slope + checks, 0, 255);
}
int brighter(int x, int y, int channel) {
  return std::clamp(scene(x, y, channel) + 12, 0, 255);
}
int noisy(int x, int y, int channel) {
  return std::clamp(scene(x, y, channel) + (x * 73 + y * 151 + channel * 199 + x * y % 17 * 37) % 41 - 20, 0, 255);
}
int moved(int x, int y, int channel) {
  return scene(x - 1, y, channel);
}
int blurred(int x, int y, int channel) {
  int sum = 0;
  for (int i = 0; i < 9; ++i) sum += scene(x + i % 3 - 1, y + i / 3 - 1, channel);
  return (sum + 4) / 9;
}
int red_for_blue(int x, int y, int channel) {
  return scene(x, y, 2 - channel);
}
int sparks(int x, int y, int channel) {
  return (7 * x + 13 * y) % 61 == 0 ? 255 : scene(x, y, channel);
}

Picture picture_of(const Formula& formula, int w = width, int h = height) {
  Picture picture{static_cast<uint32_t>(w), static_cast<uint32_t>(h), {}, {}};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      for (int channel = 0; channel < 3; ++channel)
        picture.shown.push_back(static_cast<uint8_t>(formula(x, y, channel)));
      picture.shown.push_back(255);
    }
  picture.radiance.resize(picture.shown.size());
  std::transform(picture.shown.begin(), picture.shown.end(), picture.radiance.begin(),
                 [](uint8_t shown) { return static_cast<float>(shown) / 255.0f; });
  return picture;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// rmse: NumPy 1.24, sqrt(mean((a / 255 - b / 255)²)).
// ssim: scikit-image 0.19.3, structural_similarity(a / 255, b / 255, channel_axis=2, gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False, data_range=1), the arguments that its manual gives for matching Wang et al.
// flip and after: NVlabs/flip 1.6 (C++), FLIP::evaluate(), LDR with default parameters, of the pictures in linear RGB:
// the mean, and the pixels at (10, 10), first and last.
struct Case {
  const char* name;
  Formula formula;
  double rmse;
  double ssim;
  double flip;
  float flip_at_10_10;
  float flip_first;
  float flip_last;
};
const std::vector<Case> cases{
    {"brighter", brighter, 0.047058824, 0.992752519, 0.2355726, 0.265177f, 0.233850f, 0.249432f},
    {"noisy", noisy, 0.046214270, 0.624515671, 0.0877478, 0.044597f, 0.075740f, 0.308456f},
    {"moved", moved, 0.042182505, 0.853838883, 0.0951218, 0.159533f, 0.012012f, 0.527277f},
    {"blurred", blurred, 0.028634455, 0.893101095, 0.0546595, 0.045105f, 0.010144f, 0.247688f},
    {"red for blue", red_for_blue, 0.233091085, 0.409805035, 0.5054198, 0.819676f, 0.953413f, 0.780495f},
    {"sparks", sparks, 0.072002946, 0.642581244, 0.0979654, 0.020751f, 0.986965f, 0.002096f},
};

TEST(PlayerMetrics, RmseIsNumPys) {
  const Picture a = picture_of(scene);
  for (const Case& c : cases) {
    const Differences d = differences(a, picture_of(c.formula), {});
    EXPECT_NEAR(d.rmse_shown, c.rmse, 1e-8) << c.name;
    EXPECT_NEAR(d.rmse_linear, c.rmse, 1e-7) << c.name;
  }
}

// A ramp 0..255 against black: the mean of squares 0² … 255² is 255 · 511 / 6.
TEST(PlayerMetrics, RmseHasItsClosedForm) {
  const Picture ramp = picture_of([](int x, int, int) { return x; }, 256, 3);
  const Picture black = picture_of([](int, int, int) { return 0; }, 256, 3);
  EXPECT_NEAR(differences(ramp, black, {}).rmse_shown, std::sqrt(255.0 * 511.0 / 6.0) / 255.0, 1e-12);
}

TEST(PlayerMetrics, SsimIsScikitImages) {
  const Picture a = picture_of(scene);
  for (const Case& c : cases) {
    EXPECT_NEAR(ssim(a, picture_of(c.formula)).value(), c.ssim, 1e-8) << c.name;
    EXPECT_NEAR(ssim(picture_of(c.formula), a).value(), c.ssim, 1e-8) << c.name << ", the other way round";
  }
  EXPECT_NEAR(ssim(a, a).value(), 1.0, 1e-12);
}

// Between even pictures of values a and b all variances are 0: (2 a b + C1) / (a² + b² + C1).
TEST(PlayerMetrics, SsimOfEvenPicturesHasItsClosedForm) {
  const Picture dark = picture_of([](int, int, int) { return 51; }, 16, 12);
  const Picture bright = picture_of([](int, int, int) { return 204; }, 16, 12);
  EXPECT_NEAR(ssim(dark, bright).value(), (2 * 0.2 * 0.8 + 1e-4) / (0.04 + 0.64 + 1e-4), 1e-9);
}

TEST(PlayerMetrics, SsimNeedsRoomForItsWindow) {
  EXPECT_TRUE(ssim(picture_of(scene, 11, 11), picture_of(noisy, 11, 11)));
  EXPECT_FALSE(ssim(picture_of(scene, 10, 11), picture_of(noisy, 10, 11)));
  EXPECT_FALSE(ssim(picture_of(scene, 11, 10), picture_of(noisy, 11, 10)));
}

TEST(PlayerMetrics, FlipIsItsAuthors) {
  EXPECT_NEAR(flip_pixels_per_degree, 67.020645, 1e-5);
  const Picture a = picture_of(scene);
  for (const Case& c : cases) {
    const std::vector<float> map = flip_map(a, picture_of(c.formula));
    EXPECT_NEAR(mean(map), c.flip, 5e-6) << c.name;
    EXPECT_NEAR(map[10 * width + 10], c.flip_at_10_10, 2e-5) << c.name;
    EXPECT_NEAR(map.front(), c.flip_first, 2e-5) << c.name;
    EXPECT_NEAR(map.back(), c.flip_last, 2e-5) << c.name;
    EXPECT_NEAR(differences(a, picture_of(c.formula), map).flip, mean(map), 1e-12);
    EXPECT_EQ(flip_map(picture_of(c.formula), a), map) << c.name << ", the other way round";
  }
}

// Green against blue is the farthest that colours can be apart; with no features between them nothing is added.
TEST(PlayerMetrics, FlipGoesFromNoneToOne) {
  const auto even = [](int r, int g, int b) {
    return picture_of([=](int, int, int channel) { return channel == 0 ? r : channel == 1 ? g : b; }, 5, 3);
  };
  EXPECT_NEAR(mean(flip_map(even(0, 255, 0), even(0, 0, 255))), 1.0, 1e-6);
  EXPECT_EQ(mean(flip_map(even(9, 99, 199), even(9, 99, 199))), 0.0);
  const double near = mean(flip_map(even(100, 100, 100), even(104, 100, 100)));
  const double far = mean(flip_map(even(100, 100, 100), even(140, 100, 100)));
  EXPECT_GT(near, 0.0);
  EXPECT_GT(far, near);
}

// matplotlib 3.6.3: cm.magma.colors, times 255.
TEST(PlayerMetrics, MagmaIsMatplotlibs) {
  const auto expect_near = [](int place, int r, int g, int b) {
    const auto color = magma_color(static_cast<float>(place) / 255.0f);
    EXPECT_NEAR(color[0], r, 3) << place;
    EXPECT_NEAR(color[1], g, 3) << place;
    EXPECT_NEAR(color[2], b, 3) << place;
  };
  expect_near(0, 0, 0, 4);
  expect_near(32, 29, 17, 71);
  expect_near(100, 137, 40, 129);
  expect_near(200, 253, 152, 105);
  expect_near(255, 252, 253, 191);
  const auto two = colored(std::vector<float>{0.0f, 4.0f}, 4.0f, magma_color);
  EXPECT_EQ(two, (std::vector<uint8_t>{0, 0, 4, 252, 253, 191}));
}

}  // namespace
}  // namespace chandelier::player
