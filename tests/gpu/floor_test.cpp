// SPDX-License-Identifier: Apache-2.0
// A bare floor under one light has the radiance that the formulas of glTF 2.0 (appendix B) and KHR_lights_punctual
// give, worked out here in doubles, without the runtime's code.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "gpu_test.h"

namespace chandelier::test {
namespace {

using Double3 = glm::dvec3;
constexpr double pi = 3.14159265358979323846;

// The g-buffer keeps the square root of the base colour in 10 bits: half a step of 1/1023 in a root of sqrt(0.5) is
// 0.07 % of it and 0.14 % of its square; at 0.2 it is 0.22 %. Normals along an axis are kept exactly, distances come
// from a 32-bit depth. Specular terms add the rounding of roughness to 16 bits. What a window or a cone cuts off is
// compared against the brightest pixel.
constexpr double relative_tolerance = 0.003;
constexpr double absolute_tolerance = 1e-5;  // of the brightest pixel

struct Floor {
  glm::vec3 base_color{0.5f};
  double metallic = 0.0;
  double roughness = 1.0;
};

struct Expected {
  pack::Light light;
  Floor floor;
  Shade shade;
  Double3 eye;
};

// KHR_lights_punctual: what arrives per square metre of a surface that faces the light.
double illuminance(const pack::Light& light, const Double3& p) {
  if (light.type == pack::LightType::directional) return light.intensity;
  const Double3 d = Double3(light.position_ws) - p;
  const double distance = glm::length(d);
  double arriving =
      light.intensity * std::clamp(1.0 - std::pow(distance / light.range_m, 4.0), 0.0, 1.0) / (distance * distance);
  if (light.type == pack::LightType::spot) {
    const double inner = light.inner_cone_cos, outer = light.outer_cone_cos;
    const double cosine = glm::dot(Double3(light.direction_ws), -d / distance);
    const double cone = std::clamp((cosine - outer) / std::max(0.001, inner - outer), 0.0, 1.0);
    arriving *= cone * cone;
  }
  return arriving;
}

// Smith's auxiliary function of GGX for a direction that makes the cosine c with the normal (Heitz 2014, JCGT 3(2), eq.
// 72).
double smith_lambda(double c, double alpha) {
  const double tangent2 = (1.0 - c * c) / (c * c);
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
}

// glTF 2.0 appendix B.3.5, with the height-correlated masking-shadowing of Heitz (eq. 99), as Khronos' own renderers
// have it; appendix B.3.2 prints the separable form, which is darker on rough surfaces at a slant.
Double3 ggx(const Floor& floor, const Double3& n, const Double3& l, const Double3& v) {
  const Double3 h = glm::normalize(l + v);
  const double n_l = glm::dot(n, l), n_v = glm::dot(n, v), n_h = glm::dot(n, h), v_h = glm::dot(v, h);
  const double alpha = floor.roughness * floor.roughness, alpha2 = alpha * alpha;
  const double d = alpha2 / (pi * std::pow(n_h * n_h * (alpha2 - 1.0) + 1.0, 2.0));
  const double g = 1.0 / (1.0 + smith_lambda(n_l, alpha) + smith_lambda(n_v, alpha));
  const Double3 base(floor.base_color);
  const Double3 diffuse_color = base * (1.0 - floor.metallic);
  const Double3 f0 = Double3(0.04) * (1.0 - floor.metallic) + base * floor.metallic;
  const Double3 f = f0 + (Double3(1.0) - f0) * std::pow(1.0 - v_h, 5.0);
  return (Double3(1.0) - f) * diffuse_color / pi + f * (d * g / (4.0 * n_l * n_v));
}

Double3 expected_radiance(const Expected& e, const Double3& p) {
  const Double3 n(0, 1, 0);
  const Double3 l = e.light.type == pack::LightType::directional ? -Double3(e.light.direction_ws)
                                                                 : glm::normalize(Double3(e.light.position_ws) - p);
  const double arriving = illuminance(e.light, p) * std::max(0.0, glm::dot(n, l));
  if (e.shade == Shade::lambert) return Double3(e.floor.base_color) * (arriving / pi);
  return ggx(e.floor, n, l, glm::normalize(e.eye - p)) * arriving * Double3(e.light.color);
}

struct Difference {
  double relative = 0.0;  // worst, where something is expected
  uint32_t lit = 0;
  uint32_t dark = 0;
};

class FloorTest : public GpuTest {
 protected:
  // Every pixel must be floor: the camera looks down at a slant, to the left of the light.
  void expect_radiance(const pack::Light& light, const Floor& floor, Filter filter, Shade shade, uint32_t least_lit,
                       uint32_t least_dark) {
    Scene scene;
    scene.add(level_square({0, 0, 0}, 10.0f),
              scene.add_material(plain_material(floor.base_color, static_cast<float>(floor.metallic),
                                                static_cast<float>(floor.roughness))));
    scene.lights = {light};
    Recipe recipe;
    recipe.filter = filter;
    recipe.shade = shade;
    recipe.face_size_px = 256;
    const auto settings = settings_for(look({-0.7f, 2.5f, 1.9f}, {0.2f, 0, -0.3f}, 1.0f), 160, 128, recipe);
    const Picture picture = draw(device(), scene, settings);
    const Expected expected{light, floor, shade, Double3(settings.camera.eye_ws)};
    double brightest = 0.0;
    for (size_t i = 0; i < picture.radiance.size(); ++i)
      if (i % 4 != 3) brightest = std::max(brightest, double{picture.radiance[i]});
    Difference difference;
    for (uint32_t y = 0; y < settings.height; ++y)
      for (uint32_t x = 0; x < settings.width; ++x)
        compare(expected_radiance(expected, Double3(floor_point(settings, x, y))), Double3(radiance_at(picture, x, y)),
                brightest * absolute_tolerance, difference);
    EXPECT_LE(difference.relative, relative_tolerance);
    EXPECT_GE(difference.lit, least_lit);
    EXPECT_GE(difference.dark, least_dark);
    RecordProperty("worst_relative_difference", std::to_string(difference.relative));
    std::cout << "worst relative difference " << difference.relative << ", lit " << difference.lit << ", dark "
              << difference.dark << "\n";
  }

  static void compare(const Double3& expected, const Double3& found, double slack, Difference& difference) {
    for (int channel = 0; channel < 3; ++channel)
      difference.relative =
          std::max(difference.relative, std::max(0.0, std::abs(found[channel] - expected[channel]) - slack) /
                                            std::max(expected[channel], slack));
    ++(expected.x > 0.0 ? difference.lit : difference.dark);
  }
};

constexpr uint32_t all_pixels = 160 * 128;
const glm::vec3 above(0.4f, 1.6f, -0.2f);

TEST_F(FloorTest, PointLightLambertHard) {
  expect_radiance(point_light(above, 40, 12), {}, Filter::hard, Shade::lambert, all_pixels, 0);
}
TEST_F(FloorTest, PointLightLambertPcf) {
  expect_radiance(point_light(above, 40, 12), {}, Filter::pcf, Shade::lambert, all_pixels, 0);
}
TEST_F(FloorTest, PointLightEndsAtItsRange) {
  expect_radiance(point_light(above, 40, 2), {}, Filter::hard, Shade::lambert, 4000, 5000);
}
TEST_F(FloorTest, SpotLightInsideItsConesBetweenAndOutside) {
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss})
    expect_radiance(spot_light(above, {-0.3f, -1, 0.25f}, 60, 9, 0.25f, 0.5f), {}, filter, Shade::lambert, 2000, 5000);
}
TEST_F(FloorTest, WideSpotLightReachesTheSideFacesOfItsCube) {
  expect_radiance(spot_light({0.4f, 0.5f, -0.2f}, {-1, -0.2f, 0.6f}, 60, 9, 0.7f, 1.2f), {}, Filter::hard,
                  Shade::lambert, 5000, 1000);
}
TEST_F(FloorTest, DirectionalLight) {
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss})
    expect_radiance(directional_light({0.5f, -1, 0.3f}, 3), {}, filter, Shade::lambert, all_pixels, 0);
}
// Two lights share a map that is read through a disc a quarter of a metre wide: a floor must not shadow itself, not
// even where the disc reaches over an edge of the cube onto a face at another slope.
TEST_F(FloorTest, LightClusterWithAWideDisc) {
  Scene scene;
  scene.add(level_square({0, 0, 0}, 10.0f), scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.lights = {point_light({0.4f, 1.2f, -0.2f}, 40, 12), point_light({0.5f, 1.25f, -0.28f}, 30, 11)};
  Recipe recipe;
  recipe.select = Select::light_clusters;
  recipe.filter = Filter::pcf;
  recipe.shade = Shade::lambert;
  recipe.d_init_m = 1.6f;
  const auto settings = settings_for(look({-0.7f, 2.5f, 1.9f}, {0.2f, 0, -0.3f}, 1.0f), 160, 128, recipe);
  const Picture picture = draw(device(), scene, settings);
  Difference difference;
  for (uint32_t y = 0; y < settings.height; ++y) {
    for (uint32_t x = 0; x < settings.width; ++x) {
      const Double3 p(floor_point(settings, x, y));
      Double3 expected(0.0);
      for (const pack::Light& light : scene.lights)
        expected += expected_radiance({light, {}, Shade::lambert, Double3(settings.camera.eye_ws)}, p);
      compare(expected, Double3(radiance_at(picture, x, y)), 1e-5, difference);
    }
  }
  EXPECT_LE(difference.relative, relative_tolerance);
}

TEST_F(FloorTest, PointLightGgx) {
  for (const double roughness : {0.25, 0.6, 1.0})
    for (const double metallic : {0.0, 0.4, 1.0})
      expect_radiance(point_light(above, 40, 12), {{0.8f, 0.5f, 0.2f}, metallic, roughness}, Filter::hard, Shade::ggx,
                      all_pixels, 0);
}
TEST_F(FloorTest, DirectionalLightGgx) {
  expect_radiance(directional_light({-0.5f, -1, -0.6f}, 3), {{0.5f, 0.5f, 0.5f}, 0.0, 0.4}, Filter::hard, Shade::ggx,
                  all_pixels, 0);
}

}  // namespace
}  // namespace chandelier::test
