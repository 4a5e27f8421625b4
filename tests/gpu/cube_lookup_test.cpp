// SPDX-License-Identifier: Apache-2.0
// Lookups in cube shadow maps, drawn by the runtime's own stages, agree with rays that Embree traces.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <random>

#include "../rays/embree_scene.h"
#include "gpu_test.h"
#include "shaders/lookup_comp.h"
#include "shading/targets.h"
#include "shadows/cull/cull.h"
#include "shadows/project/shadow_views.h"
#include "shadows/raster/caster_pass.h"
#include "shadows/store/map_groups.h"

namespace chandelier::test {
namespace {

constexpr float room_m = 5.0f;  // half of it
constexpr uint32_t lookups = 40000;

using Random = std::mt19937;

float uniform(Random& random, float from, float to) {
  return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
}
glm::vec3 uniform3(Random& random, float from, float to) {
  const float x = uniform(random, from, to), y = uniform(random, from, to);
  return {x, y, uniform(random, from, to)};
}
glm::vec3 unit_vector(Random& random) {
  glm::vec3 v;
  do v = uniform3(random, -1.0f, 1.0f);
  while (glm::dot(v, v) > 1.0f || glm::dot(v, v) < 0.01f);
  return glm::normalize(v);
}

// A room with 400 boxes and spheres: turned, stretched, some mirrored, some reaching into each other.
Scene cluttered_room(Random& random) {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
  scene.add(box(glm::vec3(-room_m), glm::vec3(room_m)), material);
  const Mesh unit_box = box(glm::vec3(-0.5f), glm::vec3(0.5f));
  const Mesh ball = sphere(glm::vec3(0.0f), 0.5f, 16);
  for (uint32_t i = 0; i < 400; ++i) {
    glm::mat4 place = glm::translate(glm::mat4(1.0f), uniform3(random, -room_m, room_m));
    place = glm::rotate(place, uniform(random, 0, 6.0f), unit_vector(random));
    glm::vec3 scale = uniform3(random, 0.15f, 0.7f);
    if (i % 5 == 0) scale.x = -scale.x;
    scene.add(i % 2 ? ball : unit_box, material, glm::scale(place, scale));
  }
  for (uint32_t i = 0; i < 12; ++i)
    scene.lights.push_back(point_light(uniform3(random, -4.5f, 4.5f), 10, uniform(random, 4, 9)));
  return scene;
}

// As lookup.comp has it, scalar layout.
struct Question {
  glm::vec3 p;
  uint32_t map;
  glm::vec3 n;
};
static_assert(sizeof(Question) == 28);

// Half on surfaces, evenly by area, half anywhere in the room; with a normal that looks towards the light, within
// range.
std::vector<Question> ask(Random& random, const std::vector<std::array<glm::vec3, 3>>& triangles,
                          const std::vector<frame::ShadowMap>& maps) {
  std::vector<float> area_up_to;
  float area = 0.0f;
  for (const auto& t : triangles) area_up_to.push_back(area += glm::length(glm::cross(t[1] - t[0], t[2] - t[0])));
  std::vector<Question> questions;
  while (questions.size() < lookups) {
    Question q;
    q.map = static_cast<uint32_t>(random() % maps.size());
    if (questions.size() % 2) {
      const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, uniform(random, 0, area));
      const auto& t = triangles[static_cast<size_t>(found - area_up_to.begin())];
      float u = uniform(random, 0, 1), v = uniform(random, 0, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      q.p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      q.n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    } else {
      q.p = uniform3(random, -room_m, room_m);
      q.n = unit_vector(random);
    }
    const glm::vec3 d = maps[q.map].center_ws - q.p;
    if (glm::dot(q.n, d) < 0.0f) q.n = -q.n;
    if (glm::length(d) < maps[q.map].range_m && glm::length(d) > 0.2f) questions.push_back(q);
  }
  return questions;
}

// What rays say of a lookup, and whether it lies in the band in which a map of this resolution may be wrong. A lookup
// is outside the band where ten rays agree: from the point, and from the four points of its tangent plane that lie one
// texel away from it diagonally as the light sees them, each raised off that plane by next to nothing and by a whole
// texel.
enum class Truth { lit, dark, band };
Truth truth(const EmbreeScene& rays, const Question& q, const glm::vec3& light, uint32_t face_size_px) {
  const glm::vec3 d = q.p - light;
  const int axis = std::abs(d.x) >= std::abs(d.y) && std::abs(d.x) >= std::abs(d.z) ? 0
                   : std::abs(d.y) >= std::abs(d.z)                                 ? 1
                                                                                    : 2;
  const float depth = std::abs(d[axis]);
  const float texel_m = 2.0f * depth / static_cast<float>(face_size_px);
  uint32_t lit = 0, dark = 0;
  for (int corner = 0; corner < 5; ++corner) {
    glm::vec3 toward = d;
    if (corner < 4) {
      toward[(axis + 1) % 3] += corner & 1 ? texel_m : -texel_m;
      toward[(axis + 2) % 3] += corner & 2 ? texel_m : -texel_m;
    }
    const float along = glm::dot(q.n, d) / glm::dot(q.n, toward);  // where that way meets the tangent plane
    if (!(along > 0.5f && along < 2.0f)) return Truth::band;
    for (const float lift_m : {1e-4f, texel_m})
      ++(rays.blocked(light + toward * along + q.n * lift_m, light) ? dark : lit);
  }
  return dark == 0 ? Truth::lit : (lit == 0 ? Truth::dark : Truth::band);
}

// The maps of a scene's lights and what lookup.comp needs to read them.
struct Maps {
  LightList list;
  std::vector<frame::ShadowView> views;
  CubeArray store;
};

class CubeLookupTest : public GpuTest {
 protected:
  template <typename T>
  gpu::Buffer upload(const std::vector<T>& records) {
    return gpu::upload_buffer(device(), std::as_bytes(std::span(records)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  }

  // Runs select, project, cull and rasterize as a frame does, all maps in one group. Sizes go to the maps in turns.
  Maps draw_maps(const pack::File& pack, uint32_t layer_size_px, const std::vector<uint32_t>& sizes_px) {
    const World world(pack);
    const GpuScene scene = upload_scene(device(), world);
    const Camera camera = look({0, 0, 40}, {0, 0, 0}, 1.0f);  // sees the whole room
    Maps maps;
    maps.list = select_lights(world, {}, camera, 1.0f);
    for (size_t i = 0; i < maps.list.maps.size(); ++i) maps.list.maps[i].size_px = sizes_px[i % sizes_px.size()];
    maps.views = project_lights(maps.list, camera, 1.0f, world.bounds());
    const auto count = static_cast<uint32_t>(maps.list.maps.size());
    const auto groups = plan_groups(maps.list, {.cubes = count, .layer_size_px = layer_size_px});
    EXPECT_EQ(groups.size(), 1u);
    const auto view_count = static_cast<uint32_t>(maps.views.size());
    maps.store = make_cube_array(device(), layer_size_px, groups[0].cube_count);
    maps.store.maps.place(groups[0], world, Cull::light_frustum, maps.list, maps.views);

    const CullPipelines cull = make_cull_pipelines(device(), Cull::light_frustum, false);
    const CasterPipelines casters = make_caster_pipelines(device(), scene);
    gpu::Uploader uploader(device(), 0, {});
    CullState draws = make_cull_state(device(), uploader, lists_for_shadows(pack.view()));
    uploader.finish();
    gpu::Retired retired;
    make_room(device(), {.maps = count, .views = view_count}, retired, draws);
    const gpu::Buffer map_buffer = upload(maps.list.maps);
    const gpu::Buffer views = upload(maps.views);
    const gpu::Buffer counters = upload(std::vector<frame::CullCounters>(1));
    gpu::run_once(device(), [&](gpu::Commands cmd) {
      const CullInput input{.views = views,
                            .maps = map_buffer,
                            .counters = counters,
                            .first_map = 0,
                            .map_count = count,
                            .view_count = view_count,
                            .group = 0};
      record_boxes(cmd, device(), cull, scene, input, draws);
      EXPECT_EQ(record_cull(cmd, device(), cull, scene, input, draws), 1u);
      const CasterInput drawn{.culled = draws,
                              .views = views,
                              .store = maps.store,
                              .maps = maps.list.maps,
                              .cube_count = groups[0].cube_count,
                              .keeps = false};
      begin_casters(cmd, drawn);
      record_casters(cmd, casters, scene, drawn, 0);
      end_casters(cmd, drawn);
    });
    return maps;
  }

  std::vector<float> answers(const Maps& maps, const std::vector<Question>& questions, Filter filter = Filter::hard) {
    const auto pipeline =
        gpu::make_compute_pipeline(device(), lookup_comp,
                                   {{"filter_answer", static_cast<uint32_t>(filter)},
                                    {"parts_of_layers", has_parts_of_layers(maps.list.maps, maps.store)}});
    const auto nearest = gpu::make_sampler(device(), {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO});
    const auto comparing = gpu::make_sampler(device(), {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                                        .magFilter = VK_FILTER_LINEAR,
                                                        .minFilter = VK_FILTER_LINEAR,
                                                        .compareEnable = VK_TRUE,
                                                        .compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL});
    const gpu::Buffer view =
        upload(std::vector<frame::ViewConstants>{{.face_size_px = static_cast<float>(maps.store.layer_size_px)}});
    const gpu::Buffer map_buffer = upload(maps.list.maps), views = upload(maps.views), asked = upload(questions);
    const gpu::Buffer out =
        gpu::make_buffer(device(), questions.size() * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::readback);
    gpu::run_once(device(), [&](gpu::Commands cmd) {
      gpu::bind(cmd, pipeline,
                {{"View", gpu::storage(view)},
                 {"Maps", gpu::storage(map_buffer)},
                 {"Views", gpu::storage(views)},
                 {"Questions", gpu::storage(asked)},
                 {"Answers", gpu::storage(out)},
                 {"layer_depths", gpu::sampled(maps.store.depth.view, nearest)},
                 {"cubes", gpu::sampled(maps.store.cubes, comparing)},
                 {"layers", gpu::sampled(maps.store.depth.view, comparing)},
                 {"cube_depths", gpu::sampled(maps.store.cubes, nearest)}});
      gpu::dispatch(cmd, device(), pipeline, questions.size());
      gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                          VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    });
    const auto* values = reinterpret_cast<const float*>(out.mapped);
    return {values, values + questions.size()};
  }

  void expect_agreement(uint32_t layer_size_px, const std::vector<uint32_t>& sizes_px, uint32_t seed) {
    Random random(seed);
    const pack::File pack = cluttered_room(random).open();
    const auto triangles = world_triangles(pack.view());
    const Maps maps = draw_maps(pack, layer_size_px, sizes_px);
    const auto questions = ask(random, triangles, maps.list.maps);
    const auto found = answers(maps, questions);
    const EmbreeScene rays(triangles);
    uint32_t lit = 0, dark = 0, band = 0, wrong = 0;
    for (size_t i = 0; i < questions.size(); ++i) {
      const frame::ShadowMap& map = maps.list.maps[questions[i].map];
      const Truth expected = truth(rays, questions[i], map.center_ws, map.size_px);
      lit += expected == Truth::lit;
      dark += expected == Truth::dark;
      band += expected == Truth::band;
      wrong += expected != Truth::band && found[i] != (expected == Truth::lit ? 1.0f : 0.0f);
    }
    const double agreement = 1.0 - double{1.0} * wrong / (lit + dark);
    std::cout << layer_size_px << " texels: " << 100.0 * agreement << " % of " << lit + dark << " lookups agree ("
              << lit << " lit, " << dark << " dark, " << wrong << " wrong), " << band << " in the band\n";
    RecordProperty("agreement", std::to_string(agreement));
    EXPECT_GE(agreement, 0.999);
    EXPECT_GT(lit, lookups / 10);  // or the figure would mean little
    EXPECT_GT(dark, lookups / 10);
    EXPECT_LT(band, lookups / 3);
  }
};

TEST_F(CubeLookupTest, AgreesWithRays256) {
  expect_agreement(256, {256}, 1);
}
TEST_F(CubeLookupTest, AgreesWithRays512) {
  expect_agreement(512, {512}, 2);
}
TEST_F(CubeLookupTest, AgreesWithRaysWhereMapsHaveManySizes) {
  expect_agreement(512, {512, 256, 256, 512, 128, 300}, 3);
}

// Maps that lie in squares of larger layers are read as those that have whole layers: but for taps that cross the
// border of a face, which are held at it.
TEST_F(CubeLookupTest, SquaresOfLayersAreReadAsWholeOnes) {
  Random random(4);
  Scene scene = cluttered_room(random);
  pack::Material cut = plain_material(glm::vec3(0.8f));
  cut.base_color_texture = scene.add_texture(2, 2, {0xFFFFFFFFu, 0x00FFFFFFu, 0x00FFFFFFu, 0xFFFFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  const uint32_t masked = scene.add_material(cut);
  for (int i = 0; i < 40; ++i)
    scene.add(quad(uniform3(random, -room_m, room_m), unit_vector(random), unit_vector(random)), masked);
  const pack::File pack = scene.open();
  const Maps whole = draw_maps(pack, 128, {128}), parts = draw_maps(pack, 512, {128});
  ASSERT_LT(parts.store.cube_count, whole.store.cube_count);
  auto questions = ask(random, world_triangles(pack.view()), whole.list.maps);
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    const auto expected = answers(whole, questions, filter), found = answers(parts, questions, filter);
    uint32_t other = 0;
    double difference = 0.0;
    for (size_t i = 0; i < questions.size(); ++i) {
      other += std::abs(found[i] - expected[i]) > 1.0f / 255.0f;
      difference += std::abs(found[i] - expected[i]) / static_cast<double>(questions.size());
    }
    std::cout << name_of(filter) << ": " << other << " of " << questions.size() << " differ, mean " << difference
              << "\n";
    EXPECT_LT(other, questions.size() / (filter == Filter::hard ? 1000 : 50));
    EXPECT_LT(difference, 0.002);
  }
}

}  // namespace
}  // namespace chandelier::test
