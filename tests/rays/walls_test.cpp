// SPDX-License-Identifier: Apache-2.0
// Walls between lights: what counts as one, by rays and by voxels.
#include "lights/walls.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "bake/bake.h"

namespace chandelier::lights {
namespace {

using baker::Primitive;

void add_box(Primitive& out, const glm::vec3& low, const glm::vec3& high) {
  const auto first = static_cast<uint32_t>(out.vertices.size());
  for (uint32_t i = 0; i < 8; ++i)
    out.vertices.push_back({.position_ls = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}});
  for (const uint32_t corner :
       {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    out.indices.push_back(first + corner);
}

/// Boxes and point lights, baked.
class Place {
 public:
  Primitive boxes;
  std::vector<baker::Light> lights;
  bool throws_shadow = true, by_material = false;

  uint32_t light(const glm::vec3& position_ws) {
    lights.push_back({.name = std::to_string(lights.size()), .position_ws = position_ws, .range_m = 5.0f});
    return static_cast<uint32_t>(lights.size() - 1);
  }
  bool between(WallTest test, uint32_t a, uint32_t b) {
    if (!pack_) bake();
    const pack::View view = pack::view_of(*pack_);
    const World world(view);
    const rays::PackRays rays(view);
    Walls walls(world, rays);
    const bool found = walls.between(test, a, b);
    EXPECT_EQ(walls.between(test, a, b), found);
    EXPECT_EQ(walls.between(test, b, a), found);
    EXPECT_EQ(Walls(world, rays).between(test, b, a), found);
    return found;
  }
  const pack::Contents& bake() {
    baker::Scene scene;
    scene.materials.emplace_back();
    scene.meshes.emplace_back().primitives = {boxes};
    scene.instances.emplace_back().mesh = 0;
    scene.instances[0].shadowless = !throws_shadow && !by_material;
    scene.materials[0].shadowless = !throws_shadow && by_material;
    scene.lights = lights;
    baker::Report report;
    baker::Warnings warnings;
    pack_ = baker::bake(std::move(scene), {}, baker::Progress(false), report, warnings);
    return *pack_;
  }

 private:
  std::optional<pack::Contents> pack_;
};

// Two rooms of 8 by 3 by 6 m, the wall between them 10 cm thick, and in it a doorway of 1 m at its front end.
Place two_rooms() {
  Place place;
  add_box(place.boxes, {-8, -0.2f, -3}, {8, 0, 3});
  add_box(place.boxes, {-8, 3, -3}, {8, 3.2f, 3});
  add_box(place.boxes, {-0.05f, 0, -3}, {0.05f, 3, 2});
  return place;
}

// What is remembered of a pair is forgotten when one of the two moves, or an instance.
TEST(Walls, AreLookedForAnewWhereSomethingMoved) {
  Place place = two_rooms();
  const LightId left = place.light({-0.5f, 2, -1}), right = place.light({0.5f, 2, -1});
  const pack::Contents& pack = place.bake();
  World world(pack::view_of(pack));
  rays::PackRays rays(world.pack());
  Walls walls(world, rays);
  EXPECT_TRUE(walls.between(WallTest::rays, left, right));
  const pack::Light before = world.lights()[right];
  pack::Light beside = before;
  beside.position_ws = {-0.5f, 2, -1.5f};
  world.set_light(right, beside);
  EXPECT_FALSE(walls.between(WallTest::rays, left, right));
  world.set_light(right, before);
  EXPECT_TRUE(walls.between(WallTest::rays, left, right));

  const std::array<glm::vec4, 3> away{glm::vec4(1, 0, 0, 50), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)};
  world.set_transform(0, away);
  rays.set_transform(0, away);
  EXPECT_FALSE(walls.between(WallTest::rays, left, right));
  EXPECT_THROW(walls.between(WallTest::voxels, left, right), std::invalid_argument);
}

TEST(Walls, StandBetweenLampsBackToBack) {
  Place place = two_rooms();
  const uint32_t left = place.light({-0.25f, 1.7f, 0}), right = place.light({0.25f, 1.7f, 0});
  const uint32_t further = place.light({-0.9f, 1.7f, 0.3f}), ceiling = place.light({0.3f, 2.97f, 0});
  const uint32_t other_ceiling = place.light({-0.3f, 2.97f, 0.1f}), low = place.light({0.25f, 0.05f, -2.95f});
  const uint32_t other_low = place.light({-0.25f, 0.05f, -2.95f});
  EXPECT_TRUE(place.between(WallTest::rays, left, right));
  EXPECT_TRUE(place.between(WallTest::rays, further, right));
  EXPECT_TRUE(place.between(WallTest::rays, ceiling, other_ceiling));  // one cannot step through the ceiling
  EXPECT_TRUE(place.between(WallTest::rays, left, ceiling));
  EXPECT_FALSE(place.between(WallTest::rays, low, other_low));  // around the wall's back edge
  EXPECT_FALSE(place.between(WallTest::rays, left, further));
  EXPECT_FALSE(place.between(WallTest::rays, left, left));
  EXPECT_FALSE(place.between(WallTest::none, left, right));
}

// Glass, or what its author wants to be looked through by lights.
TEST(Walls, AreNotWhatThrowsNoShadow) {
  for (const bool by_material : {false, true}) {
    Place place = two_rooms();
    place.throws_shadow = false, place.by_material = by_material;
    const uint32_t left = place.light({-0.25f, 1.7f, 0}), right = place.light({0.25f, 1.7f, 0});
    EXPECT_FALSE(place.between(WallTest::rays, left, right));
    EXPECT_FALSE(place.between(WallTest::voxels, left, right));
  }
}

TEST(Walls, LeaveDoorwaysOpen) {
  Place place = two_rooms();
  const uint32_t left = place.light({-0.3f, 1.5f, 2.5f}), right = place.light({0.3f, 1.5f, 2.5f});
  const uint32_t behind_left = place.light({-0.3f, 1.5f, 1.9f}), behind_right = place.light({0.3f, 1.5f, 1.9f});
  EXPECT_FALSE(place.between(WallTest::rays, left, right));
  EXPECT_FALSE(place.between(WallTest::rays, behind_left, behind_right));  // blocked, but only just
}

TEST(Walls, AreNotPropsThatOneCanStepAround) {
  Place place;
  add_box(place.boxes, {-0.03f, 0, -0.03f}, {0.03f, 3, 0.03f});     // a pole
  add_box(place.boxes, {1.9f, 1.4f, -0.12f}, {2.1f, 1.6f, 0.12f});  // a lamp's body
  add_box(place.boxes, {3.97f, 1, -0.5f}, {4.03f, 2, 0.5f});        // a panel of a square metre
  const uint32_t pole = place.light({-0.3f, 1.5f, 0}), pole_too = place.light({0.3f, 1.5f, 0});
  const uint32_t body = place.light({1.7f, 1.5f, 0}), body_too = place.light({2.3f, 1.5f, 0});
  const uint32_t panel = place.light({3.7f, 1.5f, 0}), panel_too = place.light({4.3f, 1.5f, 0});
  const uint32_t far = place.light({3.0f, 1.5f, 0}), far_too = place.light({5.0f, 1.5f, 0});
  EXPECT_FALSE(place.between(WallTest::rays, pole, pole_too));
  EXPECT_FALSE(place.between(WallTest::rays, body, body_too));
  EXPECT_TRUE(place.between(WallTest::rays, panel, panel_too));
  EXPECT_FALSE(place.between(WallTest::rays, far, far_too));  // wide from near, small from afar
}

TEST(Walls, AreCellsWithTrianglesBetweenTheLightsOwn) {
  Place place;
  add_box(place.boxes, {-8, -0.2f, -8}, {8, 0, 8});
  add_box(place.boxes, {-8, 15.8f, -8}, {8, 16, 8});
  add_box(place.boxes, {-0.05f, 0, -8}, {0.05f, 16, 8});  // cells are half a metre wide
  const uint32_t left = place.light({-1.3f, 7, 0}), right = place.light({1.3f, 7, 0}), near = place.light({0.1f, 7, 0});
  const uint32_t further = place.light({-3.3f, 7, 2});
  EXPECT_TRUE(place.between(WallTest::voxels, left, right));
  EXPECT_FALSE(place.between(WallTest::voxels, left, further));
  EXPECT_FALSE(place.between(WallTest::voxels, near, right));  // its own cell has the wall in it
}

// Of a segment within a box of one cell, as a part of the segment.
double length_in_cell(const pack::VoxelGrid& grid, const glm::ivec3& cell, const glm::dvec3& a, const glm::dvec3& b) {
  double enter = 0, leave = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = double{grid.bounds_min_ws[axis]} + cell[axis] * double{grid.cell_size_m[axis]};
    const double t0 = (low - a[axis]) / (b[axis] - a[axis]);
    const double t1 = (low + double{grid.cell_size_m[axis]} - a[axis]) / (b[axis] - a[axis]);
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return leave - enter;
}

bool contains(const pack::VoxelGrid& grid, const glm::ivec3& cell, const glm::dvec3& p) {
  const glm::dvec3 at = (p - glm::dvec3(grid.bounds_min_ws)) / glm::dvec3(grid.cell_size_m);
  return glm::ivec3(glm::floor(at)) == cell;
}

// Also by hand, on ways of any direction and length: whether the longest part in an occupied cell is longer than none.
TEST(Walls, ByVoxelsAreThoseOfEveryCellOnTheWay) {
  std::mt19937 random(3);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  Place place;
  for (int i = 0; i < 150; ++i) {
    const glm::vec3 low(uniform(-5, 5), uniform(-2, 2), uniform(-9, 9));
    add_box(place.boxes, low, low + glm::vec3(uniform(0.1f, 1), uniform(0.1f, 2), uniform(0.1f, 1)));
  }
  const pack::Contents& pack = place.bake();
  ASSERT_GT(pack.voxel_grid.at(0).no_cull_run_count, 0u);
  const Occupancy occupancy(pack::view_of(pack));
  std::vector<glm::ivec3> occupied;
  const auto& size = pack.voxel_grid[0].resolution;
  for (uint32_t i = 0; i < size[0] * size[1] * size[2]; ++i) {
    const glm::ivec3 cell(i % size[0], i / size[0] % size[1], i / size[0] / size[1]);
    if (occupancy.is_occupied(cell)) occupied.push_back(cell);
  }
  uint32_t found = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::vec3 a(uniform(-8, 8), uniform(-4, 4), uniform(-12, 12));
    const glm::vec3 b = a + uniform(0.1f, 1.0f) * glm::vec3(uniform(-4, 4), uniform(-2, 2), uniform(-4, 4));
    double longest = 0;
    for (const glm::ivec3& cell : occupied)
      if (!contains(pack.voxel_grid[0], cell, a) && !contains(pack.voxel_grid[0], cell, b))
        longest = std::max(longest, length_in_cell(pack.voxel_grid[0], cell, a, b));
    if (longest > 0 && longest < 1e-6) continue;  // a corner, touched
    EXPECT_EQ(occupancy.between(a, b), longest > 0) << i;
    found += longest > 0;
  }
  EXPECT_GT(found, 500u);
  EXPECT_LT(found, 4500u);
}

// A point of any triangle is in an occupied cell; a cell far from all of them is not.
TEST(Walls, ByVoxelsHoldEveryTriangle) {
  Place place = two_rooms();
  const pack::Contents& pack = place.bake();
  const Occupancy occupancy(pack::view_of(pack));
  const pack::VoxelGrid& grid = pack.voxel_grid.at(0);
  const auto cell_of = [&](const glm::vec3& p) {
    return glm::ivec3(glm::floor((p - grid.bounds_min_ws) / grid.cell_size_m));
  };
  for (float s = 0.01f; s < 1.0f; s += 0.02f) {
    for (float t = 0.01f; t < 1.0f; t += 0.02f) {
      EXPECT_TRUE(occupancy.is_occupied(cell_of({-8 + 16 * s, 3, -3 + 6 * t})));
      EXPECT_TRUE(occupancy.is_occupied(cell_of({0.05f, 3 * s, -3 + 5 * t})));
      EXPECT_FALSE(occupancy.is_occupied(cell_of({1.0f + 6 * s, 0.5f + 2 * t, -2 + 4 * s})));
    }
  }
}

TEST(Walls, ByVoxelsNeedVoxels) {
  pack::Contents nothing;
  EXPECT_THROW(Occupancy(pack::view_of(nothing)), std::invalid_argument);
}

}  // namespace
}  // namespace chandelier::lights
