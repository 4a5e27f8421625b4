// SPDX-License-Identifier: Apache-2.0
// How far the nearest triangle is that casts a shadow, which shadow maps take their near plane from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bake/light_audit.h"
#include "bake/light_rays.h"
#include "gltf_builder.h"
#include "light_near.h"

namespace chandelier::baker::test {
namespace {

/// Triangles all over a box of 20 m, on two nodes, and lamps among them.
GltfBuilder soup_with_lamps(int triangles, int lamps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-10, 10), size(-1, 1);
  GltfBuilder gltf;
  std::vector<float> xyz;
  std::vector<uint16_t> indices;
  for (int i = 0; i < triangles; ++i) {
    const glm::vec3 at(place(random), place(random), place(random));
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) xyz.push_back(at[axis] + size(random));
      indices.push_back(static_cast<uint16_t>(indices.size()));
    }
  }
  gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(xyz)}}}, {"indices", gltf.add_indices(indices)}});
  gltf.add_node({{"mesh", 0}});
  gltf.add_node({{"mesh", 0}, {"translation", {3, -1, 2}}, {"scale", {-1, 0.5, 1}}});
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 4}}};
  for (int i = 0; i < lamps; ++i)
    gltf.add_node({{"translation", {place(random), place(random), place(random)}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return gltf;
}

/// Ericson 2005, Real-Time Collision Detection, 5.1.5.
glm::dvec3 closest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  return a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc));
}

double nearest_of_all(const pack::Contents& pack, const glm::dvec3& p, double most_m) {
  double nearest = most_m;
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    const pack::Batch& batch = pack.batches[draw.batch];
    for (uint32_t i = 0; i < batch.index_count; i += 3) {
      glm::dvec3 corners[3];
      for (uint32_t k = 0; k < 3; ++k) {
        const glm::dvec4 local(glm::dvec3(pack.positions[pack.indices[batch.first_index + i + k].vertex].position_ls),
                               1);
        for (int row = 0; row < 3; ++row)
          corners[k][row] = glm::dot(glm::dvec4(pack.instances[draw.instance].world_from_local[row]), local);
      }
      nearest = std::min(nearest, glm::distance(p, closest_point(p, corners[0], corners[1], corners[2])));
    }
  }
  return nearest;
}

TEST(NearestCaster, IsTheNearestOfAllTriangles) {
  const pack::Contents pack = soup_with_lamps(400, 200).bake();
  ASSERT_EQ(pack.lights.size(), 200u);
  int nearer_than_range = 0;
  for (const pack::Light& light : pack.lights) {
    const double expected = nearest_of_all(pack, glm::dvec3(light.position_ws), light.range_m);
    EXPECT_NEAR(light.nearest_caster_m, expected, 1e-6 + 1e-6 * expected);
    EXPECT_LE(light.nearest_caster_m, expected + 1e-12);
    nearer_than_range += expected < light.range_m;
  }
  EXPECT_GT(nearer_than_range, 150);
}

TEST(NearestCaster, LeavesOutWhatThrowsNoShadow) {
  pack::Contents pack = soup_with_lamps(50, 1).bake();
  const glm::dvec3 at(pack.lights[0].position_ws);
  const std::vector<uint32_t> moving = moving_batch_instances(pack);
  EXPECT_LT(nearest_caster_m(pack, moving, at, 100), 100);
  for (pack::Instance& instance : pack.instances) instance.shadowless = 1;
  EXPECT_EQ(nearest_caster_m(pack, moving, at, 100), 100);
  for (pack::Instance& instance : pack.instances) instance.shadowless = 0;
  for (pack::Material& material : pack.materials) material.shadowless = 1;
  EXPECT_EQ(nearest_caster_m(pack, moving, at, 100), 100);
}

/// A lamp so far under a level square of 2 m.
GltfBuilder lamp_under_a_ceiling(double below_m) {
  GltfBuilder gltf;
  gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions({-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1})}}},
                 {"indices", gltf.add_indices({0, 1, 2, 0, 2, 3})}});
  gltf.add_node({{"mesh", 0}});
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 4}}};
  gltf.add_node({{"name", "lamp"},
                 {"translation", {0.3, -below_m, 0.2}},
                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return gltf;
}

TEST(NearestCaster, SetsTheNearPlane) {
  const auto near_m = [](double below_m) {
    return pack::shadow_near_m(lamp_under_a_ceiling(below_m).bake().lights.at(0));
  };
  EXPECT_EQ(near_m(1), pack::most_shadow_near_m);
  EXPECT_NEAR(near_m(0.006), 0.57 * 0.006, 1e-6);  // a face of the cube sees it no nearer than that
  EXPECT_EQ(near_m(0.00005), pack::least_shadow_near_m);
}

std::vector<std::string> warnings_of(const GltfBuilder& gltf) {
  Warnings warnings;
  Report report;
  bake(gltf.import(), {}, Progress(Progress::Shown::nothing), report, warnings);
  return warnings.lines();
}

TEST(NearestCaster, IsNamedWhereNoNearPlaneIsNearEnough) {
  EXPECT_TRUE(warnings_of(lamp_under_a_ceiling(0.0005)).empty());
  const auto lines = warnings_of(lamp_under_a_ceiling(0.0001));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("within 0.18 mm of a surface, which may cast no shadow from their light (lamp)"),
            std::string::npos)
      << lines[0];
  GltfBuilder away = lamp_under_a_ceiling(0.0001);  // a spot light that shines away from it
  away.json["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "spot";
  away.json["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"] = Json::object();
  away.json["nodes"][1]["rotation"] = {-0.70710678, 0, 0, 0.70710678};
  for (const std::string& line : warnings_of(away)) EXPECT_EQ(line.find("of a surface"), std::string::npos) << line;
}

}  // namespace
}  // namespace chandelier::baker::test
