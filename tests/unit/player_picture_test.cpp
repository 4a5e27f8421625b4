// SPDX-License-Identifier: Apache-2.0
// What the player makes of pictures: files read back by another library, errors, heat maps, reports.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "pack_sample.h"
#include "player/compare.h"
#include "player/image_files.h"
#include "player/metrics/color_maps.h"
#include "player/report.h"
#include "player/stats.h"

namespace chandelier::player {
namespace {

namespace fs = std::filesystem;
using pack::test::Folder;

// No two pixels, channels or rows alike, and radiance beyond 1.
Picture made_picture(uint32_t width, uint32_t height) {
  Picture picture{width, height, {}, {}};
  for (uint32_t i = 0; i < width * height * 4; ++i) {
    picture.radiance.push_back(0.125f * static_cast<float>(i) + 0.01f);
    picture.shown.push_back(static_cast<uint8_t>((i * 37 + i / 4) % 256));
  }
  return picture;
}

std::vector<float> read_floats(const fs::path& path, uint32_t width, uint32_t height) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    ADD_FAILURE() << OIIO::geterror();
    return {};
  }
  EXPECT_EQ(input->spec().width, static_cast<int>(width));
  EXPECT_EQ(input->spec().height, static_cast<int>(height));
  EXPECT_EQ(input->spec().nchannels, 3);
  std::vector<float> values(size_t{width} * height * 3);
  EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data())) << input->geterror();
  return values;
}

void expect_radiance(const fs::path& path, const Picture& picture) {
  const std::vector<float> values = read_floats(path, picture.width, picture.height);
  for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], picture.radiance[i / 3 * 4 + i % 3]) << "value " << i;
}

TEST(PlayerPictures, PngHoldsTheShownBytes) {
  const Folder folder;
  const Picture picture = made_picture(13, 7);
  write_picture(folder / "a.png", picture);
  const auto input = OIIO::ImageInput::open((folder / "a.png").string());
  ASSERT_TRUE(input) << OIIO::geterror();
  ASSERT_EQ(input->spec().nchannels, 3);
  std::vector<uint8_t> bytes(13 * 7 * 3);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
  for (size_t i = 0; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], picture.shown[i / 3 * 4 + i % 3]) << "byte " << i;
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(PlayerPictures, ExrAndPfmHoldTheExactRadiance) {
  const Folder folder;
  const Picture picture = made_picture(13, 7);
  for (const char* name : {"a.exr", "a.pfm"}) {
    write_picture(folder / name, picture);
    expect_radiance(folder / name, picture);
  }
  EXPECT_EQ(folder.names().size(), 2u);
}

TEST(PlayerPictures, SamePictureSameBytes) {
  const Folder folder;
  const Picture picture = made_picture(13, 7);
  for (const char* name : {"first.png", "first.exr", "first.pfm"}) write_picture(folder / name, picture);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a time of writing would be another second
  for (const std::string extension : {".png", ".exr", ".pfm"}) {
    write_picture(folder / ("second" + extension), picture);
    const std::vector<char> bytes = pack::test::read_file(folder / ("first" + extension));
    EXPECT_FALSE(bytes.empty());
    EXPECT_TRUE(bytes == pack::test::read_file(folder / ("second" + extension))) << extension;
  }
}

TEST(PlayerPictures, KindsByExtension) {
  EXPECT_EQ(image_kind("a.png"), ImageKind::png);
  EXPECT_EQ(image_kind("b.EXR"), ImageKind::exr);
  EXPECT_EQ(image_kind("c.d.pfm"), ImageKind::pfm);
  for (const char* name : {"a.jpg", "png", "a", "", "a.png.bak", ".png"}) EXPECT_FALSE(image_kind(name)) << name;
}

TEST(PlayerPictures, FailedWritesLeaveNothingAndKeepWhatWasThere) {
  const Folder folder;
  fs::create_directory(folder / "taken.png");
  EXPECT_THROW(write_file(folder / "taken.png", "x"), std::runtime_error);
  EXPECT_THROW(check_writable(folder / "taken.png"), std::runtime_error);
  EXPECT_THROW(write_file(folder / "no/a.png", "x"), std::runtime_error);
  EXPECT_THROW(check_writable(folder / "no/a.png"), std::runtime_error);
  EXPECT_EQ(folder.names().size(), 1u);
  EXPECT_TRUE(fs::is_directory(folder / "taken.png"));
}

TEST(PlayerPictures, DevicesAreWrittenInPlaceAndTheirErrorsSeen) {
  EXPECT_NO_THROW(write_file("/dev/null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(write_file("/dev/full", "x"), std::runtime_error);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(PlayerCompare, DifferencesMatchHandValues) {
  Picture a{2, 1, {0, 0, 0, 1, 1, 1, 1, 1}, {0, 0, 0, 255, 100, 100, 100, 255}};
  Picture b{2, 1, {3, 0, 0, 9, 1, 1, 5, 1}, {51, 0, 0, 0, 100, 100, 0, 255}};  // alpha must not count
  const Differences d = differences(a, b, std::vector{0.25f, 0.75f});
  EXPECT_NEAR(d.rmse_linear, std::sqrt((9.0 + 16.0) / 6.0), 1e-12);
  EXPECT_NEAR(d.max_linear, 4.0, 1e-12);
  EXPECT_NEAR(d.rmse_shown, std::sqrt((0.2 * 0.2 + (100.0 / 255.0) * (100.0 / 255.0)) / 6.0), 1e-12);
  EXPECT_NEAR(d.max_shown, 100.0 / 255.0, 1e-12);
  EXPECT_EQ(d.flip, 0.5);
  EXPECT_FALSE(d.ssim) << "no window fits";
  const auto values = shown_differences(a, b);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_FLOAT_EQ(values[0], 0.2f);
  EXPECT_FLOAT_EQ(values[1], 100.0f / 255.0f);
  const Differences none = differences(a, a, {});
  EXPECT_EQ(none.rmse_linear, 0.0);
  EXPECT_EQ(none.max_shown, 0.0);
  b.width = 1;
  EXPECT_THROW(differences(a, b, {}), std::invalid_argument);
}

TEST(PlayerCompare, HeatGoesFromDarkBlueToRed) {
  const auto low = heat_color(0.0f);
  const auto high = heat_color(1.0f);
  EXPECT_TRUE(low[0] == 0 && low[1] == 0 && low[2] > 0 && low[2] < 128) << "dark blue at 0";
  EXPECT_TRUE(high[0] == 255 && high[1] == 0 && high[2] == 0) << "red at 1";
  // Red never falls; from cyan on blue never rises; hue (blue, cyan, yellow, red) always moves on.
  auto before = low;
  for (int i = 1; i <= 1000; ++i) {
    const auto color = heat_color(static_cast<float>(i) / 1000.0f);
    EXPECT_GE(color[0], before[0]) << i;
    if (i <= 500) {
      EXPECT_GE(color[1], before[1]) << i;
      EXPECT_GE(color[2], before[2]) << i;
    } else {
      EXPECT_LE(color[2], before[2]) << i;
    }
    EXPECT_LE(color[0] - before[0] + std::abs(color[1] - before[1]) + std::abs(color[2] - before[2]), 8)
        << "a jump at " << i;
    before = color;
  }
  EXPECT_EQ(heat_color(-1.0f), low);
  EXPECT_EQ(heat_color(2.0f), high);
}

TEST(PlayerCompare, HeatScaleIgnoresStrayPixels) {
  std::vector<float> values(10000, 0.25f);
  values[17] = 1.0f;
  EXPECT_FLOAT_EQ(heat_scale(values), 0.25f);
  std::vector<float> nearly_same(10000, 0.0f);
  nearly_same[42] = 0.5f;
  EXPECT_FLOAT_EQ(heat_scale(nearly_same), 0.5f);
  EXPECT_FLOAT_EQ(heat_scale(std::vector<float>(100, 0.0f)), 1.0f / 255.0f);
}

TEST(PlayerStats, MediansOfOddAndEvenCounts) {
  const auto frame = [](double ms) {
    FrameStats stats;
    stats.frame_ms = ms;
    stats.stages = {{"shade", ms * 2, ms * 3}};
    return stats;
  };
  const std::vector<FrameStats> frames{frame(9), frame(1), frame(4), frame(2)};
  EXPECT_DOUBLE_EQ(medians(frames).frame_ms, 3.0);
  const FrameStats odd = medians(std::span(frames).first(3));
  EXPECT_DOUBLE_EQ(odd.frame_ms, 4.0);
  EXPECT_DOUBLE_EQ(odd.stages[0].gpu_ms, 8.0);
  EXPECT_DOUBLE_EQ(odd.stages[0].cpu_ms, 12.0);
}

TEST(PlayerReport, EscapesHtml) {
  EXPECT_EQ(escape_html("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escape_html("plain é"), "plain é");
}

TEST(PlayerReport, NothingFromOutsideReachesThePageUnescaped) {
  Comparison comparison;
  for (player::Run* run : {&comparison.a, &comparison.b}) {
    run->pack = "<script>pack</script>";
    run->device = "<b>device</b>";
    run->driver = "\"driver\" & <i>co</i>";
    run->camera.name = "<img src=x>";
    run->preset = run == &comparison.a ? "reference" : "light<cluster";
    run->image = "it's \"a\".png";
    run->settings.width = run->settings.height = 4;
    run->frames = 1;
    run->stats.stages = {{"<stage>", 1.0, 1.0}};
  }
  comparison.difference_image = "difference.png";
  comparison.heat_scale = 0.1f;
  comparison.flip_image = "<flip>.png";
  const std::string html = report_html(comparison);
  for (const char* raw :
       {"<script>pack", "<b>device", "<i>co", "<img src=x", "light<cluster", "<stage>", "it's \"a\"", "<flip>"})
    EXPECT_EQ(html.find(raw), std::string::npos) << raw;
  for (const char* safe : {"&lt;script&gt;pack", "&lt;b&gt;device", "&lt;stage&gt;", "it&#39;s &quot;a&quot;.png"})
    EXPECT_NE(html.find(safe), std::string::npos) << safe;
}

TEST(PlayerReport, ShowsStagesThatOnlyOneSideHas) {
  Comparison comparison;
  comparison.a.preset = "reference";
  comparison.b.preset = "lightcluster";
  comparison.a.stats.stages = {{"g-buffer", 2.0, 0.0}, {"shade", 8.0, 0.0}};
  comparison.b.stats.stages = {{"g-buffer", 2.0, 0.0}, {"visibility", 4.0, 0.0}, {"shade", 4.0, 0.0}};
  comparison.heat_scale = 0.1f;
  const std::string html = report_html(comparison);
  for (const char* name : {">g-buffer<", ">visibility<", ">shade<", ">all stages<"})
    EXPECT_NE(html.find(name), std::string::npos) << name;
  EXPECT_NE(html.find("<td class=\"n\">8.000</td><td class=\"n\">4.000</td><td class=\"n\">0.50</td>"),
            std::string::npos);
}

}  // namespace
}  // namespace chandelier::player
