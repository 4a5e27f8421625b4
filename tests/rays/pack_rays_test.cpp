// SPDX-License-Identifier: Apache-2.0
// Rays through packs meet what Embree meets, and nothing leaks out of closed rooms.
#include "rays/pack_rays.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <random>

#include "bake/bake.h"
#include "bake/batch_bvh.h"
#include "embree_scene.h"
#include "import/import.h"

namespace chandelier::rays {
namespace {

using baker::Primitive;
using test::EmbreeScene;
using test::WorldTriangle;

class Random {
 public:
  explicit Random(uint32_t seed) : bits_(seed) {}
  float between(float low, float high) { return low + (high - low) * static_cast<float>(bits_() >> 8) * 0x1p-24f; }
  glm::vec3 in_box(const glm::vec3& low, const glm::vec3& high) {
    const float x = between(low.x, high.x), y = between(low.y, high.y);
    return {x, y, between(low.z, high.z)};
  }
  glm::vec3 direction() {
    glm::vec3 v;
    do v = in_box(glm::vec3(-1), glm::vec3(1));
    while (glm::dot(v, v) > 1.0f || glm::dot(v, v) < 0.01f);
    return glm::normalize(v);
  }
  uint32_t below(size_t count) { return static_cast<uint32_t>(bits_() % count); }

 private:
  std::mt19937 bits_;
};

void add_triangle(Primitive& primitive, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (const glm::vec3& corner : {a, b, c}) {
    primitive.indices.push_back(static_cast<uint32_t>(primitive.vertices.size()));
    primitive.vertices.push_back({.position_ls = corner});
  }
}

Primitive soup(Random& random, uint32_t triangles, float size) {
  Primitive out;
  for (uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 at = random.in_box(glm::vec3(-1), glm::vec3(1));
    const float reach = size * (i % 10 == 0 ? 5.0f : 1.0f);
    add_triangle(out, at, at + reach * random.direction(), at + reach * random.direction());
  }
  return out;
}

// A closed ball of `segments` around and half as many upwards.
Primitive ball(uint32_t segments) {
  Primitive out;
  const auto at = [&](uint32_t ring, uint32_t i) {
    const float pi = std::acos(-1.0f), v = pi * static_cast<float>(ring) / static_cast<float>(segments / 2);
    const float u = 2 * pi * static_cast<float>(i % segments) / static_cast<float>(segments);
    if (ring == 0 || ring == segments / 2) return glm::vec3(0, ring == 0 ? 1 : -1, 0);
    return glm::vec3(std::sin(v) * std::cos(u), std::cos(v), -std::sin(v) * std::sin(u));
  };
  for (uint32_t ring = 0; ring < segments / 2; ++ring) {
    for (uint32_t i = 0; i < segments; ++i) {
      if (ring > 0) add_triangle(out, at(ring, i), at(ring + 1, i), at(ring, i + 1));
      if (ring + 1 < segments / 2) add_triangle(out, at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1));
    }
  }
  return out;
}

pack::Contents bake(baker::Scene&& scene) {
  baker::Report report;
  baker::Warnings warnings;
  pack::Contents pack = baker::bake(std::move(scene), {}, baker::Progress(false), report, warnings);
  baker::check(pack, report);
  return pack;
}

baker::MeshInstance placed(uint32_t mesh, const glm::dmat4& world_from_local) {
  baker::MeshInstance out;
  out.mesh = mesh;
  out.world_from_local = world_from_local;
  return out;
}

// Three soups, the last one masked, each in several places: turned, stretched, mirrored, some that move, one that is
// pressed flat.
pack::Contents soups(Random& random) {
  baker::Scene scene;
  scene.materials.resize(2);
  scene.meshes.resize(3);
  for (uint32_t m = 0; m < 3; ++m) {
    scene.meshes[m].primitives = {soup(random, 2000, 0.05f)};
    scene.meshes[m].primitives[0].material = m == 2;
  }
  for (uint32_t i = 0; i < 12; ++i) {
    glm::dmat4 place = glm::translate(glm::dmat4(1), glm::dvec3(random.in_box(glm::vec3(-2), glm::vec3(2))));
    place = glm::rotate(place, double{random.between(0, 6)}, glm::dvec3(random.direction()));
    glm::dvec3 scale(random.in_box(glm::vec3(0.3f), glm::vec3(2)));
    if (i % 4 == 1) scale.x = -scale.x;
    scene.instances.push_back(placed(i % 3, glm::scale(place, scale)));
  }
  pack::Contents pack = bake(std::move(scene));
  pack.materials[pack.batches[pack.meshes.back().first_batch].material].alpha_mode = pack::AlphaMode::mask;
  for (uint32_t i : {3u, 7u, 10u}) pack.instances[i].dynamic = 1;
  pack.instances[0].world_from_local[1] = {0, 0, 0, 0.25f};
  for (pack::BatchInstance& draw : pack.batch_instances)
    if (draw.instance == 0) draw.bounds_min_ws.y = draw.bounds_max_ws.y = 0.25f;
  baker::PassReport pass;
  baker::make_batch_bvh(pass, pack);
  baker::make_instance_bvh(pass, pack);
  return pack;
}

glm::vec3 in_world(const pack::Instance& instance, const glm::vec3& p_ls) {
  const auto& rows = instance.world_from_local;
  const glm::vec4 p(p_ls, 1.0f);
  return {glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)};
}

// All that can be met.
std::vector<WorldTriangle> world_triangles(const pack::View& pack) {
  std::vector<WorldTriangle> out;
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    const pack::Batch& batch = pack.batches[draw.batch];
    if (pack.materials[batch.material].alpha_mode == pack::AlphaMode::mask) continue;
    for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
      WorldTriangle& t = out.emplace_back();
      for (uint32_t c = 0; c < 3; ++c)
        t[c] = in_world(pack.instances[draw.instance], pack.positions[pack.indices[i + c].vertex].position_ls);
    }
  }
  return out;
}

// Where Embree is asked the same question about rays moved by next to nothing, does it say both yes and no? Such a ray
// grazes an edge.
bool grazes(const EmbreeScene& embree, Random& random, const glm::vec3& from, const glm::vec3& to, float gap,
            float extent_m) {
  uint32_t yes = 0;
  for (uint32_t i = 0; i < 64; ++i) {
    const float shift_m = extent_m * (i % 2 ? 3e-6f : 3e-7f);
    yes += embree.blocked(from + shift_m * random.direction(), to + shift_m * random.direction(), gap);
  }
  return yes > 0 && yes < 64;
}

void expect_agreement(const pack::View& pack, uint32_t count, uint32_t seed) {
  const PackRays rays(pack);
  const auto triangles = world_triangles(pack);
  const EmbreeScene embree(triangles);
  Random random(seed);
  const glm::vec3 low = pack.bake_info->bounds_min_ws, high = pack.bake_info->bounds_max_ws;
  const float extent_m = glm::length(glm::max(glm::abs(low), glm::abs(high)));
  uint32_t blocked = 0, other_blocked = 0, other_first = 0, met = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 from = random.in_box(low, high);
    glm::vec3 to = random.in_box(low, high);
    if (i % 2) {  // to a surface
      const WorldTriangle& t = triangles[random.below(triangles.size())];
      to = t[0] + (t[1] - t[0]) * random.between(0, 0.5f) + (t[2] - t[0]) * random.between(0, 0.5f);
    }
    const float gap = PackRays::end_gap_m(from, to) / glm::distance(from, to);
    if (!(gap < 0.1f)) continue;
    const bool expected = embree.blocked(from, to, gap);
    blocked += expected;
    if (rays.blocked(from, to) != expected) {
      ++other_blocked;
      EXPECT_TRUE(grazes(embree, random, from, to, gap, extent_m)) << "ray " << i;
    }
    const auto first = embree.first(from, to - from);
    const auto hit = rays.first_hit(from, to - from, INFINITY);
    const float way_m = glm::distance(from, to);
    met += hit.has_value();
    if (hit && std::abs(hit->distance_m - first.t * way_m) <= 1e-5f * (extent_m + hit->distance_m)) {
      EXPECT_NEAR(glm::length(hit->normal_ws), 1.0f, 1e-4f);
    } else if (hit.has_value() != std::isfinite(first.t) || hit) {
      ++other_first;
      const float reach = std::min(first.t, hit ? hit->distance_m / way_m : INFINITY);
      EXPECT_TRUE(grazes(embree, random, from, from + (to - from) * reach * 1.0001f, 0.0f, extent_m)) << "ray " << i;
    }
  }
  std::cout << count << " rays, " << blocked << " blocked, " << met << " meet something; " << other_blocked << " and "
            << other_first << " graze an edge and are answered otherwise than by Embree\n";
  EXPECT_GT(blocked, count / 20);
  EXPECT_LE(other_blocked, count / 1000);
  EXPECT_LE(other_first, count / 1000);
}

TEST(PackRays, AgreeWithEmbreeOnSoups) {
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    const pack::Contents pack = soups(random);
    expect_agreement(pack::view_of(pack), 10000, seed);
  }
}

TEST(PackRays, AgreeWithEmbreeWithoutHierarchies) {
  Random random(4);
  pack::Contents pack = soups(random);
  pack.instance_bvh = {};
  pack.instance_bvh_items = {};
  expect_agreement(pack::view_of(pack), 1000, 4);
  pack.triangle_bvh = {};
  pack.triangle_bvh_items = {};
  pack.triangle_bvh_areas = {};
  for (pack::Mesh& mesh : pack.meshes) mesh.first_node = mesh.node_count = 0;
  expect_agreement(pack::view_of(pack), 1000, 5);
}

// Two balls, one within the other, which casts no shadow: by its instance, by its material, and found without trees.
TEST(PackRays, PassWhatThrowsNoShadowWhereTheyAskForCasters) {
  for (const int way : {0, 1, 2, 3}) {
    SCOPED_TRACE(way);
    baker::Scene scene;
    scene.materials.resize(2);
    scene.meshes.resize(2);
    scene.meshes[0].primitives = {ball(24)};
    scene.meshes[1].primitives = {ball(24)};
    scene.meshes[1].primitives[0].material = 1;
    scene.instances = {placed(0, glm::dmat4(1)), placed(1, glm::scale(glm::dmat4(1), glm::dvec3(3)))};
    pack::Contents pack = bake(std::move(scene));
    (way % 2 ? pack.instances[1].shadowless : pack.materials[1].shadowless) = 1;
    if (way >= 2) {
      pack.instance_bvh = {}, pack.instance_bvh_items = {};
      pack.triangle_bvh = {}, pack.triangle_bvh_items = {}, pack.triangle_bvh_areas = {};
      for (pack::Mesh& mesh : pack.meshes) mesh.first_node = mesh.node_count = 0;
    }
    const pack::View view = pack::view_of(pack);
    const PackRays rays(view);
    const glm::vec3 from(0, 0.1f, 5), towards(0, 0, -1);
    const auto seen = rays.first_hit(from, towards, 9), caster = rays.first_hit(from, towards, 9, Meets::casters);
    ASSERT_TRUE(seen && caster);
    EXPECT_EQ(seen->instance, 1u);
    EXPECT_NEAR(seen->distance_m, 2, 0.05);
    EXPECT_EQ(caster->instance, 0u);
    EXPECT_NEAR(caster->distance_m, 4, 0.05);
    EXPECT_FALSE(rays.blocked(from, {0, 0.1f, 1.5f}));
    EXPECT_TRUE(rays.blocked(from, {0, 0.1f, 0}));
  }
}

TEST(PackRays, DoNotLeakOutOfAClosedBall) {
  baker::Scene scene;
  scene.materials.emplace_back();
  scene.meshes.resize(1);
  scene.meshes[0].primitives = {ball(48)};
  const glm::dmat4 place =
      glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(31, -7, 12)), 0.7, glm::dvec3(0.6, 0.8, 0));
  scene.instances = {placed(0, glm::scale(place, glm::dvec3(4, 9, 5)))};
  const pack::Contents pack = bake(std::move(scene));
  const PackRays rays(pack::view_of(pack));
  Random random(6);
  uint32_t leaks = 0, count = 0;
  for (const WorldTriangle& t : world_triangles(pack::view_of(pack))) {
    const glm::vec3 from = in_world(pack.instances[0], 0.9f * random.between(0, 1) * random.direction());
    const float along = random.between(0, 1);
    for (const glm::vec3& at : {t[0], 0.5f * (t[0] + t[1]), t[1] + along * (t[2] - t[1])}) {
      const glm::vec3 way = at - from;
      leaks += !rays.blocked(from, from + 3.0f * way);
      leaks += !rays.first_hit(from, way, INFINITY);
      count += 2;
    }
  }
  EXPECT_GT(count, 10000u);
  EXPECT_EQ(leaks, 0u);
}

// A square of two metres in the plane y = 1, in a pack without hierarchies or with them.
pack::Contents square() {
  baker::Scene scene;
  scene.materials.emplace_back();
  scene.meshes.resize(1);
  Primitive& primitive = scene.meshes[0].primitives.emplace_back();
  add_triangle(primitive, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1});
  add_triangle(primitive, {-1, 1, -1}, {1, 1, 1}, {1, 1, -1});
  scene.instances = {placed(0, glm::dmat4(1))};
  return bake(std::move(scene));
}

TEST(PackRays, MeetWhatLiesStrictlyBetween) {
  const pack::Contents pack = square();
  const PackRays rays(pack::view_of(pack));
  EXPECT_TRUE(rays.blocked({0.3f, 0, 0.2f}, {0.1f, 2, 0.4f}));
  EXPECT_TRUE(rays.blocked({0.3f, 2, 0.2f}, {0.3f, 0, 0.2f}));   // along an axis, from the front
  EXPECT_TRUE(rays.blocked({0, 0, 0}, {0, 2, 0}));               // through the diagonal
  EXPECT_FALSE(rays.blocked({0.3f, 0, 0.2f}, {0.3f, 1, 0.2f}));  // an end lies on it
  EXPECT_FALSE(rays.blocked({0.3f, 1, 0.2f}, {0.3f, 2, 0.2f}));
  EXPECT_FALSE(rays.blocked({0.3f, 0, 0.2f}, {0.3f, 0.9f, 0.2f}));
  EXPECT_FALSE(rays.blocked({1.3f, 0, 0.2f}, {1.3f, 2, 0.2f}));
  EXPECT_FALSE(rays.blocked({0, 0, 0}, {0, 0, 0}));
}

TEST(PackRays, TellWhatTheyMeet) {
  pack::Contents pack = square();
  const PackRays rays(pack::view_of(pack));
  const auto hit = rays.first_hit({0.3f, 3, 0.2f}, {0, -4, 0}, 2.5f);
  ASSERT_TRUE(hit);
  EXPECT_FLOAT_EQ(hit->distance_m, 2.0f);
  EXPECT_NEAR(glm::distance(hit->normal_ws, glm::vec3(0, 1, 0)), 0.0f, 1e-6f);
  EXPECT_EQ(hit->instance, 0u);
  EXPECT_EQ(hit->batch, 0u);
  EXPECT_EQ(hit->material, 0u);
  EXPECT_FALSE(rays.first_hit({0.3f, 3, 0.2f}, {0, -4, 0}, 1.9f));
  EXPECT_FALSE(rays.first_hit({0.3f, 3, 0.2f}, {0, 4, 0}, INFINITY));
  pack.materials[0].alpha_mode = pack::AlphaMode::mask;
  EXPECT_FALSE(rays.first_hit({0.3f, 3, 0.2f}, {0, -4, 0}, 2.5f));
}

TEST(PackRays, MeetNothingInAnEmptyPack) {
  const pack::Contents nothing;
  EXPECT_FALSE(PackRays(pack::view_of(nothing)).blocked({0, 0, 0}, {1, 1, 1}));
}

class PackRaysOfScenes : public testing::TestWithParam<const char*> {};

TEST_P(PackRaysOfScenes, AgreeWithEmbree) {
  const std::filesystem::path path = std::filesystem::path(CHANDELIER_DATA_DIR) / "scenes" / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  baker::Scene scene;
  baker::Warnings warnings;
  baker::import_gltf(path, scene, warnings);
  for (baker::Material& material : scene.materials) {  // geometry only
    for (baker::TextureUse* use : {&material.base_color, &material.metallic_roughness, &material.normal,
                                   &material.occlusion, &material.emissive_map}) {
      use->texture = baker::no_index;
    }
  }
  const pack::Contents pack = bake(std::move(scene));
  expect_agreement(pack::view_of(pack), 10000, 7);
}

INSTANTIATE_TEST_SUITE_P(Each, PackRaysOfScenes,
                         testing::Values("crytek_sponza/crytek_sponza.gltf", "stk_candela_city/candela_city.gltf",
                                         "nexuiz_stormkeep/stormkeep.gltf"));

}  // namespace
}  // namespace chandelier::rays
