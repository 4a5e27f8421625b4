// SPDX-License-Identifier: Apache-2.0
// An occluder's shadow on a floor lies where geometry says. The camera hangs below the occluders and looks straight
// down, so that every pixel is floor.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "../unit/world_of.h"
#include "gpu_test.h"
#include "shadows/project/shadow_views.h"
#include "shadows/store/map_groups.h"

namespace chandelier::test {
namespace {

constexpr uint32_t size_px = 128;
constexpr float pi = 3.14159265f;

// Is the straight way from a floor point to the light blocked?
using Blocked = std::function<bool(const glm::vec3& floor_point)>;

struct Situation {
  Scene occluded;  // floor, light and occluder
  Blocked blocked;
  Blocked not_floor = [](const glm::vec3&) { return false; };  // what the camera sees there is the occluder itself
  uint32_t face_size_px = 256;
  float camera_height_m = 1.5f;
};

RenderSettings settings_of(const Situation& situation, Filter filter) {
  Recipe recipe;
  recipe.filter = filter;
  recipe.shade = Shade::lambert;
  recipe.face_size_px = situation.face_size_px;
  return settings_for(look({0, situation.camera_height_m, 0}, {0, 0, 0}, 0.5f * pi), size_px, size_px, recipe);
}

Scene floor_and_light(const pack::Light& light) {
  Scene scene;
  scene.add(level_square({0, 0, 0}, 8.0f), scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.lights = {light};
  return scene;
}

// Width of a texel of a cube face, projected from the light onto the floor, at its widest. A texel spans 2/N of the
// distance along the face's axis; on a face that looks down that is all; on one that looks sideways the floor rises
// through it, and a texel's height is h / r² of a metre for every metre on the floor.
float texel_on_floor(const pack::Light& light, const glm::vec3& p, uint32_t face_size_px) {
  const glm::vec3 d = glm::abs(p - light.position_ws);
  const float sideways = std::max(d.x, d.z);
  const float texel = 2.0f / static_cast<float>(face_size_px);
  return sideways <= d.y ? texel * d.y : texel * sideways * sideways / d.y;
}

// What a pixel may be.
enum class Place { lit, dark, edge };

// Edge: some point within `band_m` of the floor point is on the other side.
Place place_of(const Blocked& blocked, const glm::vec3& p, float band_m) {
  const bool here = blocked(p);
  for (uint32_t i = 0; i < 48; ++i) {
    const float angle = 2.0f * pi * static_cast<float>(i % 16) / 16.0f;
    const float radius = band_m * static_cast<float>(i / 16 + 1) / 3.0f;
    if (blocked(p + radius * glm::vec3(std::cos(angle), 0, std::sin(angle))) != here) return Place::edge;
  }
  return here ? Place::dark : Place::lit;
}

struct Counts {
  uint32_t lit = 0;
  uint32_t dark = 0;
  uint32_t edge = 0;
  uint32_t acne = 0;   // lit places that are not exactly as bright as without the occluder
  uint32_t leaks = 0;  // dark places that are not black
};

class ShadowEdgeTest : public GpuTest {
 protected:
  // `band(p)`: how far from the geometric edge a pixel may differ, metres.
  Counts compare(const Situation& situation, Filter filter, const std::function<float(const glm::vec3&)>& band) {
    const RenderSettings settings = settings_of(situation, filter);
    const Picture bare = draw(device(), floor_and_light(situation.occluded.lights[0]), settings);
    const Picture picture = draw(device(), situation.occluded, settings);
    Counts counts;
    for (uint32_t y = 0; y < size_px; ++y) {
      for (uint32_t x = 0; x < size_px; ++x) {
        const glm::vec3 p = floor_point(settings, x, y);
        if (situation.not_floor(p)) continue;
        const Place place = place_of(situation.blocked, p, band(p));
        const glm::vec3 found = radiance_at(picture, x, y);
        counts.lit += place == Place::lit;
        counts.dark += place == Place::dark;
        counts.edge += place == Place::edge;
        counts.acne += place == Place::lit && found != radiance_at(bare, x, y);
        counts.leaks += place == Place::dark && found != glm::vec3(0.0f);
      }
    }
    std::cout << "lit " << counts.lit << ", dark " << counts.dark << ", edge " << counts.edge << ", acne "
              << counts.acne << ", leaks " << counts.leaks << "\n";
    return counts;
  }

  void expect_edges(const Situation& situation, Filter filter, const std::function<float(const glm::vec3&)>& band) {
    const Counts counts = compare(situation, filter, band);
    EXPECT_EQ(counts.acne, 0u);
    EXPECT_EQ(counts.leaks, 0u);
    EXPECT_GT(counts.lit, 500u);
    EXPECT_GT(counts.dark, 200u);
    EXPECT_LT(counts.edge, counts.lit + counts.dark);
  }

  // Point and spot lights. Filter `hard` is wrong by no more than a texel; `pcf` spreads it over its disc of 1.5 texels
  // and the bilinear texel beside that. A pixel is added for the raster of the picture itself.
  void expect_edges_of_cube(const Situation& situation) {
    const pack::Light light = situation.occluded.lights[0];
    const float pixel = 2.0f * situation.camera_height_m / static_cast<float>(size_px);
    for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
      const float texels = filter == Filter::hard ? 1.0f : 2.5f;
      expect_edges(situation, filter, [&](const glm::vec3& p) {
        return texels * texel_on_floor(light, p, situation.face_size_px) + pixel;
      });
    }
  }
};

// Where the way from p to the light crosses height y.
glm::vec2 crossing(const glm::vec3& p, const glm::vec3& light, float y) {
  const glm::vec3 at = glm::mix(p, light, (y - p.y) / (light.y - p.y));
  return {at.x, at.z};
}

constexpr float occluder_y = 2.0f;
const glm::vec2 low(-0.31f, -0.2f), high(0.36f, 0.43f);  // the occluder's x and z
const glm::vec3 lamp(0.17f, 4.1f, -0.13f);

bool in_rectangle(const glm::vec2& at) {
  return at.x > low.x && at.x < high.x && at.y > low.y && at.y < high.y;
}

Mesh occluder() {
  const glm::vec2 center = 0.5f * (low + high), half = 0.5f * (high - low);
  return quad({center.x, occluder_y, center.y}, {half.x, 0, 0}, {0, 0, -half.y});
}

// The rectangle above, as `change` makes it, under a light.
Situation rectangle(const pack::Light& light, const std::function<void(Scene&)>& add_occluder) {
  Situation situation{floor_and_light(light),
                      [light](const glm::vec3& p) { return in_rectangle(crossing(p, light.position_ws, occluder_y)); }};
  add_occluder(situation.occluded);
  return situation;
}

void add_plain(Scene& scene) {
  scene.add(occluder(), scene.add_material(plain_material(glm::vec3(0.5f))));
}

TEST_F(ShadowEdgeTest, Quad) {
  expect_edges_of_cube(rectangle(point_light(lamp, 30, 12), add_plain));
}

// One row of pixels across the shadow of the quad: the sum of its visibility puts both edges within a texel of
// geometry, with either filter.
TEST_F(ShadowEdgeTest, RowsCrossTheEdgeWithinOneTexel) {
  const pack::Light light = point_light(lamp, 30, 12);
  const Situation situation = rectangle(light, add_plain);
  const float texel = texel_on_floor(light, glm::vec3(0.0f), situation.face_size_px);
  const float pixel = 2.0f * situation.camera_height_m / static_cast<float>(size_px);
  const float scale = lamp.y / (lamp.y - occluder_y);  // from the occluder to its shadow
  const float left = lamp.x + (low.x - lamp.x) * scale, right = lamp.x + (high.x - lamp.x) * scale;
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    const RenderSettings settings = settings_of(situation, filter);
    const Picture bare = draw(device(), floor_and_light(light), settings);
    const Picture picture = draw(device(), situation.occluded, settings);
    for (uint32_t y = size_px / 2 - 8; y < size_px / 2 + 8; ++y) {
      float lit_m[2] = {0, 0};  // left and right of the shadow's middle
      for (uint32_t x = 0; x < size_px; ++x)
        lit_m[floor_point(settings, x, y).x > 0.5f * (left + right)] +=
            pixel * radiance_at(picture, x, y).x / radiance_at(bare, x, y).x;
      EXPECT_NEAR(lit_m[0] - situation.camera_height_m, left, texel + pixel) << "row " << y;
      EXPECT_NEAR(situation.camera_height_m - lit_m[1], right, texel + pixel) << "row " << y;
    }
  }
}

TEST_F(ShadowEdgeTest, QuadThatTurnsItsBackToTheLight) {
  expect_edges_of_cube(rectangle(point_light(lamp, 30, 12), [](Scene& scene) {
    Mesh mesh = occluder();
    for (size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    scene.add(mesh, scene.add_material(plain_material(glm::vec3(0.5f))));
  }));
}

TEST_F(ShadowEdgeTest, DoubleSidedQuad) {
  expect_edges_of_cube(rectangle(point_light(lamp, 30, 12), [](Scene& scene) {
    pack::Material material = plain_material(glm::vec3(0.5f));
    material.double_sided = 1;
    scene.add(occluder(), scene.add_material(material));
  }));
}

// The mesh is off its origin: mirrored the wrong way, or not at all, it would cast its shadow elsewhere.
TEST_F(ShadowEdgeTest, MirroredInstance) {
  expect_edges_of_cube(rectangle(point_light(lamp, 30, 12), [](Scene& scene) {
    const glm::vec2 center = 0.5f * (low + high), half = 0.5f * (high - low);
    const Mesh mesh = quad({-0.5f * (center.x - 0.3f), 0.5f, center.y - 0.1f}, {0.5f * half.x, 0, 0}, {0, 0, -half.y});
    const glm::mat4 moved = glm::translate(glm::mat4(1.0f), {0.3f, occluder_y - 0.5f, 0.1f});
    scene.add(mesh, scene.add_material(plain_material(glm::vec3(0.5f))), glm::scale(moved, {-2, 1, 1}));
  }));
}

TEST_F(ShadowEdgeTest, MirroredTurnedBox) {
  Situation situation{floor_and_light(point_light(lamp, 30, 12)), {}};
  const glm::mat4 turned = glm::rotate(glm::translate(glm::mat4(1.0f), {-0.2f, 2.2f, 0.15f}), 0.7f, {0.3f, 1, -0.2f});
  const glm::mat4 world_from_local = glm::scale(turned, {1, -1, 0.6f});
  const glm::mat4 local_from_world = glm::inverse(world_from_local);
  const glm::vec3 half(0.3f, 0.2f, 0.45f);
  situation.occluded.add(box(-half, half), situation.occluded.add_material(plain_material(glm::vec3(0.5f))),
                         world_from_local);
  situation.blocked = [=](const glm::vec3& p) {  // slabs, in the box's own space
    const glm::vec3 from(local_from_world * glm::vec4(p, 1)), to(local_from_world * glm::vec4(lamp, 1));
    const glm::vec3 a = (-half - from) / (to - from), b = (half - from) / (to - from);
    const glm::vec3 enter = glm::min(a, b), leave = glm::max(a, b);
    return std::max({enter.x, enter.y, enter.z, 0.0f}) < std::min({leave.x, leave.y, leave.z, 1.0f});
  };
  expect_edges_of_cube(situation);
}

// Four by four texels of alpha 0 and 1: light falls through the holes.
TEST_F(ShadowEdgeTest, AlphaMaskedCheckerboard) {
  const pack::Light light = point_light(lamp, 30, 12);
  Situation situation = rectangle(light, [](Scene& scene) {
    std::vector<uint32_t> texels(16);
    for (uint32_t i = 0; i < 16; ++i) texels[i] = (i + i / 4) % 2 ? 0xFFFFFFFFu : 0x00FFFFFFu;
    pack::Material material = plain_material(glm::vec3(0.5f));
    material.base_color_texture = scene.add_texture(4, 4, texels);
    material.alpha_mode = pack::AlphaMode::mask;
    scene.add(occluder(), scene.add_material(material));
  });
  situation.face_size_px = 512;
  situation.blocked = [](const glm::vec3& p) {
    const glm::vec2 at = crossing(p, lamp, occluder_y);
    if (!in_rectangle(at)) return false;
    const glm::vec2 uv = (at - low) / (high - low);  // the quad's v grows with z
    return (static_cast<int>(uv.x * 4) + static_cast<int>(uv.y * 4)) % 2 == 1;
  };
  expect_edges_of_cube(situation);
}

// Only the faces that its cone touches are drawn.
TEST_F(ShadowEdgeTest, SpotLightAloneInItsMap) {
  expect_edges_of_cube(rectangle(spot_light(lamp, {-0.1f, -1, 0.05f}, 30, 12, 0.2f, 0.35f), add_plain));
}

// A low lamp: the shadow falls through the side faces of its cube and across their edges.
TEST_F(ShadowEdgeTest, LowLampThroughSideFaces) {
  const glm::vec3 low_lamp(-0.3f, 0.8f, 0.1f);
  const glm::vec3 min(0.25f, 0.0f, -0.35f), max(0.35f, 0.45f, 0.6f);  // a wall lower than the lamp
  Situation situation{floor_and_light(point_light(low_lamp, 30, 12)), {}};
  situation.camera_height_m = 3.0f;
  situation.face_size_px = 512;
  situation.occluded.add(box(min, max), situation.occluded.add_material(plain_material(glm::vec3(0.5f))));
  situation.blocked = [=](const glm::vec3& p) {
    const glm::vec3 a = (min - p) / (low_lamp - p), b = (max - p) / (low_lamp - p);
    const glm::vec3 enter = glm::min(a, b), leave = glm::max(a, b);
    return std::max({enter.x, enter.y, enter.z, 0.0f}) < std::min({leave.x, leave.y, leave.z, 1.0f});
  };
  const glm::vec3 eye(0, situation.camera_height_m, 0);
  situation.not_floor = [=](const glm::vec3& p) {  // the way from the eye crosses the wall's box before the floor
    const glm::vec3 at = glm::mix(p, eye, max.y / eye.y);
    const glm::vec2 lower = glm::min(glm::vec2(p.x, p.z), glm::vec2(at.x, at.z));
    const glm::vec2 upper = glm::max(glm::vec2(p.x, p.z), glm::vec2(at.x, at.z));
    return upper.x > min.x - 0.05f && lower.x < max.x + 0.05f && upper.y > min.z - 0.05f && lower.y < max.z + 0.05f;
  };
  const float pixel = 2.0f * situation.camera_height_m / static_cast<float>(size_px);
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    // Beside the texel that is sampled, a point is moved off the floor by 0.75 texels (1.5 for pcf) against acne;
    // through a side face that shows in full on the floor.
    const float texels = filter == Filter::hard ? 0.71f + 0.75f : 2.5f + 1.5f;
    expect_edges(situation, filter, [&](const glm::vec3& p) {
      return texels * texel_on_floor(situation.occluded.lights[0], p, 512) + pixel;
    });
  }
}

// The sun: cascades. A texel is measured across the light's way; on the floor it is longer by 1 / cos of the slant.
TEST_F(ShadowEdgeTest, DirectionalLight) {
  const glm::vec3 direction = glm::normalize(glm::vec3(-0.35f, -1, 0.2f));
  Situation situation{floor_and_light(directional_light(direction, 3)), [=](const glm::vec3& p) {
                        const glm::vec3 at = p - direction * ((occluder_y - p.y) / -direction.y);
                        return in_rectangle({at.x, at.z});
                      }};
  add_plain(situation.occluded);
  situation.face_size_px = 512;
  const RenderSettings settings = settings_of(situation, Filter::hard);
  LightList list = select_lights(world_of(situation.occluded.lights), settings.recipe, settings.camera, 1.0f);
  const pack::File pack = situation.occluded.open();
  const Bounds bounds{pack.view().bake_info->bounds_min_ws, pack.view().bake_info->bounds_max_ws};
  size_maps(settings.recipe, list);
  const auto views = project_lights(list, settings.camera, 1.0f, bounds);
  const auto cascade = std::find_if(views.begin(), views.end(), [&](const frame::ShadowView& view) {
    return situation.camera_height_m <= view.far_m;  // the floor is all at one depth
  });
  ASSERT_NE(cascade, views.end());
  const float cosine = -direction.y, tangent = std::sqrt(1.0f - cosine * cosine) / cosine;
  const float pixel = 2.0f * situation.camera_height_m / static_cast<float>(size_px);
  std::cout << "texel " << cascade->texel_m << " m, pixel " << pixel << " m\n";
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    // Half a texel's diagonal (pcf: its disc and a bilinear texel), and the move off the floor against acne: 1.5
    // texels, 3 for pcf, which show on the floor times the tangent.
    const float texels = filter == Filter::hard ? 0.71f / cosine + 1.5f * tangent : 2.5f / cosine + 3.0f * tangent;
    expect_edges(situation, filter, [&](const glm::vec3&) { return texels * cascade->texel_m + pixel; });
  }
}

// A row of squares above a camera that looks along the floor: their shadows run through three cascades.
TEST_F(ShadowEdgeTest, DirectionalLightFarAndNear) {
  const glm::vec3 direction = glm::normalize(glm::vec3(-0.25f, -1, 0.15f));
  Scene scene = floor_and_light(directional_light(direction, 3));
  for (int i = -7; i < 7; ++i) scene.add(level_square({0, 2, static_cast<float>(i) + 0.5f}, 0.3f), 0);
  const Blocked blocked = [&](const glm::vec3& p) {
    const glm::vec3 at = p - direction * (2.0f / -direction.y);
    return std::abs(at.x) < 0.3f && std::abs(at.z) < 7.0f && std::abs(at.z - std::floor(at.z) - 0.5f) < 0.3f;
  };
  Recipe recipe;
  recipe.shade = Shade::lambert;
  recipe.face_size_px = 512;
  const RenderSettings settings = settings_for(look({0.2f, 1.0f, 7.5f}, {-0.2f, 0.2f, 3}, 1.0f), 256, 192, recipe);
  LightList list = select_lights(world_of(scene.lights), recipe, settings.camera, 256.0f / 192.0f);
  size_maps(settings.recipe, list);
  const auto views = project_lights(list, settings.camera, 256.0f / 192.0f, {{-8, 0, -8}, {8, 2, 8}});
  const float expected = 0.5f / pi * 3.0f * -direction.y;
  const Picture picture = draw(device(), scene, settings);
  Counts counts;
  std::vector<uint32_t> dark_of_cascade(views.size());
  for (uint32_t y = 0; y < settings.height; ++y) {
    for (uint32_t x = 0; x < settings.width; ++x) {
      const glm::vec3 p = floor_point(settings, x, y);
      if (pixel_direction(settings, x, y).y > -0.02f || std::abs(p.x) > 7.5f || std::abs(p.z) > 7.5f) continue;
      const float distance = glm::distance(p, settings.camera.eye_ws);
      const float depth = glm::dot(p - settings.camera.eye_ws, settings.camera.forward_ws);
      size_t cascade = 0;
      while (depth > views[cascade].far_m) ++cascade;
      // As above, 1.5 texels cover diagonal and slant; a pixel is `distance` wide per radian and longer along the
      // floor.
      const float band_m = 1.5f * views[cascade].texel_m + distance * distance / 192.0f / settings.camera.eye_ws.y;
      const Place place = place_of(blocked, p, band_m);
      const float found = radiance_at(picture, x, y).x;
      counts.lit += place == Place::lit;
      counts.dark += place == Place::dark;
      counts.acne += place == Place::lit && std::abs(found - expected) > 0.003f * expected;
      counts.leaks += place == Place::dark && found != 0.0f;
      dark_of_cascade[cascade] += place == Place::dark;
    }
  }
  EXPECT_EQ(counts.acne, 0u);
  EXPECT_EQ(counts.leaks, 0u);
  EXPECT_GT(counts.lit, 5000u);
  EXPECT_GE(std::count_if(dark_of_cascade.begin(), dark_of_cascade.end(), [](uint32_t n) { return n > 20; }), 3);
  for (const uint32_t n : dark_of_cascade) std::cout << n << " ";
  std::cout << "dark pixels in the cascades, lit " << counts.lit << "\n";
}

// A bare floor has no dark pixel where edges between cube faces cross it, however coarse the faces.
TEST_F(ShadowEdgeTest, NoSeamsBetweenFaces) {
  for (const float height : {0.3f, 1.0f}) {
    for (const uint32_t face_size_px : {64u, 512u}) {
      const pack::Light light = point_light({0.12f, height, -0.07f}, 30, 12);
      for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
        Situation situation{floor_and_light(light), {}};
        situation.face_size_px = face_size_px;
        const RenderSettings settings = settings_of(situation, filter);
        const Picture picture = draw(device(), situation.occluded, settings);
        uint32_t wrong = 0;
        for (uint32_t y = 0; y < size_px; ++y) {
          for (uint32_t x = 0; x < size_px; ++x) {
            const glm::vec3 d = light.position_ws - floor_point(settings, x, y);
            const float distance = glm::length(d);
            const float expected = 0.5f / pi * light.intensity * (d.y / distance) *
                                   (1.0f - std::pow(distance / light.range_m, 4.0f)) / (distance * distance);
            wrong += std::abs(radiance_at(picture, x, y).x - expected) > 0.003f * expected;
          }
        }
        EXPECT_EQ(wrong, 0u) << "height " << height << ", faces " << face_size_px << ", filter "
                             << static_cast<uint32_t>(filter);
      }
    }
  }
}

}  // namespace
}  // namespace chandelier::test
