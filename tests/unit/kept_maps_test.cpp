// SPDX-License-Identifier: Apache-2.0
// Where maps lie in the pool: squares never overlap, fit whenever their area does, and what lies there unchanged stays.
#include "shadows/store/kept_maps.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "world_of.h"

namespace chandelier {
namespace {

bool overlap(const CubePlace& a, const CubePlace& b) {
  return a.cube == b.cube && a.left_px < b.left_px + b.size_px && b.left_px < a.left_px + a.size_px &&
         a.top_px < b.top_px + b.size_px && b.top_px < a.top_px + a.size_px;
}

TEST(CubePlacesTest, HoldWhatFitsAndComeTogetherAgain) {
  constexpr uint32_t layer_px = 64, cubes = 3;
  std::mt19937 random(3);
  CubePlaces places(layer_px, cubes);
  std::vector<CubePlace> taken;
  for (int step = 0; step < 20000; ++step) {
    if (random() % 2 && !taken.empty()) {
      const size_t i = random() % taken.size();
      places.give_back(taken[i]);
      std::swap(taken[i], taken.back());
      taken.pop_back();
      continue;
    }
    const uint32_t size_px = 1 + random() % layer_px;
    const auto place = places.take(size_px);
    if (!place) continue;
    EXPECT_GE(place->size_px, size_px);
    EXPECT_TRUE(place->size_px < 2 * size_px);
    EXPECT_LE(place->left_px + place->size_px, layer_px);
    EXPECT_LE(place->top_px + place->size_px, layer_px);
    EXPECT_LT(place->cube, cubes);
    for (const CubePlace& other : taken) ASSERT_FALSE(overlap(*place, other));
    taken.push_back(*place);
  }
  for (const CubePlace& place : taken) places.give_back(place);
  for (uint32_t cube = 0; cube < cubes; ++cube)
    EXPECT_EQ(places.take(layer_px), (CubePlace{cube, 0, 0, layer_px})) << "all quarters were put together";
  EXPECT_FALSE(places.take(1));
}

TEST(CubePlacesTest, RefuseWhatIsLargerThanALayer) {
  CubePlaces places(16, 1);
  EXPECT_THROW(places.take(17), std::invalid_argument);
  EXPECT_THROW(places.take(0), std::invalid_argument);
  EXPECT_TRUE(CubePlaces(15, 1).take(8));  // an odd layer is not quartered
}

pack::Light lamp() {
  pack::Light light{};
  light.type = pack::LightType::point;
  light.intensity = light.range_m = 1.0f;
  light.color = {1, 1, 1};
  light.outer_cone_cos = -1.0f;
  light.inner_cone_cos = 1.0f;
  light.direction_ws = {0, 0, -1};
  return light;
}

// A frame of lights with these ids and sizes, each light its own map with two views.
struct Frame {
  LightList list;
  std::vector<frame::ShadowView> views;
  MapGroup group{};

  explicit Frame(const std::vector<std::pair<LightId, uint32_t>>& maps) {
    for (const auto& [id, size_px] : maps) {
      const auto number = static_cast<uint32_t>(list.maps.size());
      list.maps.push_back({.size_px = size_px, .first_view = 2 * number, .view_count = 2, .first_light = number});
      list.center.push_back(id);
      for (uint32_t face = 0; face < 2; ++face) views.push_back({.layer = face, .size_px = size_px});
    }
    group.map_count = static_cast<uint32_t>(maps.size());
  }
  std::vector<uint32_t> kept() const {
    std::vector<uint32_t> kept;
    for (const frame::ShadowMap& map : list.maps) kept.push_back(map.is_kept);
    return kept;
  }
};

using Kept = std::vector<uint32_t>;

class KeptMapsTest : public testing::Test {
 protected:
  World world = test::world_of(std::vector<pack::Light>(8, lamp()));

  Frame placed(KeptMaps& maps, const std::vector<std::pair<LightId, uint32_t>>& wanted) {
    Frame frame(wanted);
    maps.place(frame.group, world, Cull::light_frustum, frame.list, frame.views);
    for (const frame::ShadowMap& map : frame.list.maps)
      for (uint32_t v = 0; v < 2; ++v) {
        const frame::ShadowView& view = frame.views[map.first_view + v];
        EXPECT_EQ(view.layer, 6 * map.cube + v);
        EXPECT_EQ(std::pair(view.left_px, view.top_px), std::pair(map.left_px, map.top_px));
      }
    return frame;
  }
};

TEST_F(KeptMapsTest, StayWhereTheyAreInAnyOrder) {
  KeptMaps maps(16, 4);
  const Frame first = placed(maps, {{0, 16}, {1, 8}, {2, 8}, {3, 16}});
  EXPECT_EQ(first.kept(), (Kept{0, 0, 0, 0}));
  EXPECT_EQ(first.list.maps[1].cube, first.list.maps[2].cube) << "two halves share a cube";
  const Frame again = placed(maps, {{3, 16}, {2, 8}, {0, 16}});
  EXPECT_EQ(again.kept(), (Kept{1, 1, 1}));
  EXPECT_EQ(again.list.maps[0].cube, first.list.maps[3].cube);
  EXPECT_EQ(again.list.maps[1].left_px, first.list.maps[2].left_px);
  EXPECT_EQ(placed(maps, {{1, 8}}).kept(), (Kept{1})) << "it was not asked for a frame ago, and still lies there";
}

TEST_F(KeptMapsTest, AreDrawnAgainWhenTheirContentsChange) {
  KeptMaps maps(16, 4);
  const std::vector<std::pair<LightId, uint32_t>> wanted{{0, 16}, {1, 16}};
  placed(maps, wanted);
  pack::Light moved = world.lights()[1];
  moved.position_ws.x += 1.0f;
  world.set_light(1, moved);
  EXPECT_EQ(placed(maps, wanted).kept(), (Kept{1, 0}));
  EXPECT_EQ(placed(maps, {{0, 8}, {1, 16}}).kept(), (Kept{0, 1})) << "another size";
  Frame turned(wanted);
  turned.views[3].range_m = 5.0f;
  maps.place(turned.group, world, Cull::light_frustum, turned.list, turned.views);
  EXPECT_EQ(turned.kept(), (Kept{1, 0})) << "another range";
  maps.forget();
  EXPECT_EQ(placed(maps, wanted).kept(), (Kept{0, 0}));
}

TEST_F(KeptMapsTest, GiveWayLeastRecentlyUsedFirst) {
  KeptMaps maps(16, 2);
  placed(maps, {{0, 16}});
  placed(maps, {{1, 16}});
  placed(maps, {{0, 16}});
  EXPECT_EQ(placed(maps, {{2, 16}}).kept(), (Kept{0}));  // takes the place of 1
  EXPECT_EQ(placed(maps, {{0, 16}, {2, 16}}).kept(), (Kept{1, 1}));
  EXPECT_EQ(placed(maps, {{1, 16}}).kept(), (Kept{0}));
}

// What is kept may lie so that no square is left that is large enough, though all of the group fits the pool.
TEST_F(KeptMapsTest, AreGivenUpWhereTheyAreInTheWay) {
  KeptMaps maps(16, 2);
  placed(maps, {{0, 8}, {1, 8}, {2, 8}, {3, 8}, {4, 8}});
  const Frame frame = placed(maps, {{0, 8}, {4, 8}, {5, 16}});
  EXPECT_EQ(frame.kept(), (Kept{0, 0, 0}));
}

TEST_F(KeptMapsTest, RandomFramesNeverShareASquareAndKeepOnlyWhatIsTheSame) {
  std::mt19937 random(11);
  KeptMaps maps(32, 3);
  struct Drawn {
    CubePlace place;
    Version version;
  };
  std::map<std::pair<LightId, uint32_t>, Drawn>
      truth;  // what lies in the pool, as the last that was drawn there left it
  for (int step = 0; step < 3000; ++step) {
    if (random() % 4 == 0) {
      const LightId id = random() % 8;
      pack::Light moved = world.lights()[id];
      moved.position_ws.y += 1.0f;
      world.set_light(id, moved);
    }
    std::vector<std::pair<LightId, uint32_t>> wanted;
    for (LightId id = 0; id < 8; ++id)
      if (random() % 2) wanted.push_back({id, 8u << random() % 2});
    const Frame frame = placed(maps, wanted);
    std::vector<CubePlace> places;
    for (size_t i = 0; i < wanted.size(); ++i) {
      const frame::ShadowMap& map = frame.list.maps[i];
      const CubePlace place{map.cube, map.top_px, map.left_px, map.size_px};
      for (const CubePlace& other : places) ASSERT_FALSE(overlap(place, other));
      places.push_back(place);
      const LightId id = wanted[i].first;
      const auto key = wanted[i];
      if (map.is_kept) {
        ASSERT_TRUE(truth.contains(key));
        ASSERT_EQ(truth.at(key).place, place);
        ASSERT_EQ(truth.at(key).version, world.light_version(id));
      }
    }
    for (size_t i = 0; i < wanted.size(); ++i)
      if (!frame.list.maps[i].is_kept)
        std::erase_if(truth, [&](const auto& old) { return overlap(old.second.place, places[i]); });
    for (size_t i = 0; i < wanted.size(); ++i) truth[wanted[i]] = {places[i], world.light_version(wanted[i].first)};
  }
}

}  // namespace
}  // namespace chandelier
