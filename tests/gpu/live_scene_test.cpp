// SPDX-License-Identifier: Apache-2.0
// What a window shows when its pack is replaced: camera, size, budget, and the older one where the device fails.
#include "player/live_scene.h"

#include <thread>

#include "../unit/pack_sample.h"
#include "gpu_test.h"

namespace chandelier::player {
namespace {

constexpr auto patience = std::chrono::seconds(60);

class LiveSceneTest : public test::GpuTest {
 protected:
  // A floor below lamps in a row, seen by a camera that is called Eye; with a texture of so many texels.
  static pack::Contents hall(uint32_t lamps, float eye_z, uint32_t texels = 1) {
    test::Scene scene;
    scene.add_texture(texels, 1, std::vector<uint32_t>(texels, 0xFFFFFFFFu));
    scene.add(test::level_square({0, 0, 0}, 8.0f), scene.add_material(test::plain_material({0.8f, 0.8f, 0.8f})));
    for (uint32_t i = 0; i < lamps; ++i)
      scene.lights.push_back(test::point_light({static_cast<float>(i) - 4.0f, 1.0f, 0.0f}, 2.0f, 3.0f));
    pack::Contents contents = scene.contents();
    contents.cameras.push_back({.position_ws = {0, 2, eye_z},
                                .yfov_rad = 1.0f,
                                .forward_ws = {0, 0, -1},
                                .up_ws = {0, 1, 0},
                                .znear_m = 0.1f,
                                .name = pack::test::add_string(contents, "Eye")});
    return contents;
  }
  void put(const pack::Contents& contents) const { pack::write(path_, contents); }
  LiveScene open(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {path_.string(), "--size", "64x36", "--face-size", "64"});
    const Parsed parsed = parse_options(arguments);
    EXPECT_TRUE(parsed.options) << parsed.text;
    return {*parsed.options, std::make_unique<const Scene>(*parsed.options), device()};
  }
  static void follow_until(LiveScene& live, const auto& is_so) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!is_so() && std::chrono::steady_clock::now() < end) {
      live.follow();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_TRUE(is_so());
  }
  static size_t lights(const LiveScene& live) { return live.scene().pack.view().lights.size(); }

  pack::test::Folder folder_;
  std::filesystem::path path_ = folder_ / "hall.chandelier";
};

TEST_F(LiveSceneTest, FollowsTheCameraUntilItIsMoved) {
  put(hall(5, 6));
  LiveScene live = open({"--camera", "Eye"});
  EXPECT_EQ(live.settings.camera.eye_ws.z, 6);
  live.settings.width = 80;
  live.settings.previous_centers = live.renderer().draw(live.settings).centers;
  put(hall(3, 7));
  follow_until(live, [&] { return lights(live) == 3; });
  EXPECT_EQ(live.settings.camera.eye_ws.z, 7);
  EXPECT_EQ(live.settings.width, 80u);
  EXPECT_EQ(live.settings.height, 36u);
  EXPECT_TRUE(live.settings.previous_centers.empty()) << "they are another pack's";
  EXPECT_EQ(live.renderer().draw(live.settings).lights, 3u);

  move(live.settings.camera, {0, 0, 1});
  for (const uint32_t lamps : {4, 6}) {  // not only the first time
    put(hall(lamps, 9));
    follow_until(live, [&] { return lights(live) == lamps; });
    EXPECT_EQ(live.settings.camera.eye_ws.z, 6) << "where one has flown to";
  }
}

// A mapping would end the program here: what is read has been cut off.
TEST_F(LiveSceneTest, ShowsACopyOfItsFile) {
  put(hall(5, 6));
  LiveScene live = open({"--preset", "lightcluster", "--walls", "rays"});
  std::filesystem::resize_file(path_, 0);
  for (int i = 0; i < 3; ++i) {
    move(live.settings.camera, {1, 0, 0});
    EXPECT_EQ(live.renderer().draw(live.settings).lights, 5u);
  }
  EXPECT_EQ(live.scene().pack.view().lights[4].range_m, 3.0f);
}

// The pack decides until someone does.
TEST_F(LiveSceneTest, TheHeadlightFollowsThePackUntilItIsToggled) {
  put(hall(0, 6));
  LiveScene live = open({});
  EXPECT_EQ(live.settings.headlight, headlight_on);
  put(hall(3, 6));
  follow_until(live, [&] { return lights(live) == 3; });
  EXPECT_EQ(live.settings.headlight, 0.0f);
  live.toggle_headlight();
  EXPECT_EQ(live.settings.headlight, headlight_on);
  put(hall(4, 6));
  follow_until(live, [&] { return lights(live) == 4; });
  EXPECT_EQ(live.settings.headlight, headlight_on);
  live.toggle_headlight();
  put(hall(0, 7));
  follow_until(live, [&] { return lights(live) == 0; });
  EXPECT_EQ(live.settings.headlight, 0.0f);
  live.renderer().draw(live.settings);
}

TEST_F(LiveSceneTest, KeepsTheBudgetAnew) {
  put(hall(9, 6));
  LiveScene live = open({"--preset", "lightcluster", "--d-init", "0.1", "--max-shadow-maps", "4"});
  EXPECT_GT(live.settings.recipe.d_init_m, 0.1f);
  EXPECT_LE(live.renderer().draw(live.settings).shadow_maps, 4u);
  put(hall(4, 6));
  follow_until(live, [&] { return lights(live) == 4; });
  EXPECT_EQ(live.settings.recipe.d_init_m, 0.1f);
  EXPECT_EQ(live.renderer().draw(live.settings).shadow_maps, 4u);
}

TEST_F(LiveSceneTest, LeavesTheOlderOneWhereTheCameraIsGone) {
  put(hall(5, 6));
  LiveScene live = open({"--camera", "Eye"});
  pack::Contents blind = hall(3, 6);
  blind.cameras.clear();
  put(blind);
  follow_until(live, [&] { return live.is_older(); });
  EXPECT_EQ(live.renderer().draw(live.settings).lights, 5u);
  put(hall(2, 6));
  follow_until(live, [&] { return !live.is_older(); });
  EXPECT_EQ(live.renderer().draw(live.settings).lights, 2u);
}

// The new one is given up when the older one's is gone from the device: it comes back.
TEST_F(LiveSceneTest, PutsTheOlderOneBackWhereTheDeviceCannotTakeTheNewOne) {
  put(hall(5, 6));
  LiveScene live = open({});
  live.settings.width = 80;
  move(live.settings.camera, {1, 0, 0});
  const Camera camera = live.settings.camera;
  live.renderer().draw(live.settings);
  const Picture before = live.renderer().read_back();
  const uint32_t largest = std::exchange(device().limits.maxImageDimension2D, 80);
  put(hall(3, 6, 128));
  follow_until(live, [&] { return live.is_older(); });
  device().limits.maxImageDimension2D = largest;
  EXPECT_EQ(live.settings.camera, camera);
  EXPECT_EQ(live.renderer().draw(live.settings).lights, 5u);
  EXPECT_EQ(live.renderer().read_back().radiance, before.radiance);
}

}  // namespace
}  // namespace chandelier::player
