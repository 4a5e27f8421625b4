// SPDX-License-Identifier: Apache-2.0
// Ambient light by direction, against integrals over the hemisphere.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lights/ambient.h"

namespace chandelier {
namespace {

constexpr double pi = std::numbers::pi;

using Radiance = std::function<glm::dvec3(const glm::dvec3&)>;

/// Over the sphere, by its area.
glm::dvec3 integral(const Radiance& f) {
  constexpr int rows = 200, columns = 400;
  glm::dvec3 sum(0.0);
  for (int row = 0; row < rows; ++row) {
    const double y = 1.0 - (row + 0.5) * 2.0 / rows, across = std::sqrt(1.0 - y * y);
    for (int column = 0; column < columns; ++column) {
      const double turn = (column + 0.5) * 2.0 * pi / columns;
      sum += f({across * std::cos(turn), y, across * std::sin(turn)});
    }
  }
  return sum * (4.0 * pi / (rows * columns));
}

glm::dvec3 irradiance_over_pi(const Radiance& radiance, const glm::dvec3& normal) {
  return integral([&](const glm::dvec3& w) { return radiance(w) * std::max(glm::dot(w, normal), 0.0); }) / pi;
}

const std::array<glm::dvec3, 7> normals = {
    glm::dvec3(0, 1, 0),     glm::dvec3(0, -1, 0),         glm::dvec3(1, 0, 0),          glm::dvec3(0, 0, -1),
    glm::dvec3(0.6, 0, 0.8), glm::dvec3(0.48, 0.6, -0.64), glm::dvec3(-0.36, -0.48, 0.8)};

void expect_irradiance(const Ambient& ambient, const Radiance& radiance, double tolerance) {
  for (const glm::dvec3& normal : normals) {
    const glm::dvec3 expected = irradiance_over_pi(radiance, normal);
    const glm::vec3 found = ambient.at(glm::vec3(normal));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << normal.x << " " << normal.y;
  }
}

std::array<double, 9> polynomials(const glm::dvec3& w) {
  return {1, w.y, w.z, w.x, w.x * w.y, w.y * w.z, 3 * w.z * w.z - 1, w.x * w.z, w.x * w.x - w.y * w.y};
}

TEST(AmbientLight, ConstantIsTheRadianceItselfToTheLastBit) {
  for (const float radiance : {0.0f, 0.3f, 1e-30f, 12345.678f})
    for (const glm::dvec3& normal : normals)
      EXPECT_EQ(Ambient::constant(radiance).at(glm::vec3(normal)), glm::vec3(radiance));
  EXPECT_TRUE(Ambient::constant(0.0f).is_dark());
  EXPECT_TRUE(Ambient::constant(2.0f).is_constant());
  EXPECT_FALSE(Ambient::between(2.0f, 1.0f).is_constant());
  EXPECT_EQ(Ambient::between(0.3f, 0.3f), Ambient::constant(0.3f));
}

TEST(AmbientLight, BetweenAboveAndBelowIsTheIntegral) {
  for (const auto& [up, down] : {std::pair(3.0f, 0.5f), std::pair(0.0f, 1.0f), std::pair(1.0f, 0.0f)})
    expect_irradiance(
        Ambient::between(up, down),
        [&](const glm::dvec3& w) { return glm::dvec3(0.5 * (up + down) + 0.5 * (up - down) * w.y); }, 5e-4);
}

// The formula of ambient.h, for light that the nine functions hold in full.
TEST(AmbientLight, CoefficientsOfAnyRadianceGiveItsIrradiance) {
  const Radiance radiance = [](const glm::dvec3& w) {
    glm::dvec3 sum(0.0);
    const auto b = polynomials(w);
    for (int i = 0; i < 9; ++i)
      sum += glm::dvec3(i == 0 ? 5.0 : 0.9, i == 0 ? 4.0 : 0.1 * i, i == 0 ? 6.0 : -0.7) * b[i];
    return sum;
  };
  Ambient ambient;
  for (int i = 0; i < 9; ++i) {
    const double a = i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25;
    const double square = integral([&](const glm::dvec3& w) { return glm::dvec3(std::pow(polynomials(w)[i], 2)); }).x;
    const glm::dvec3 projected = integral([&](const glm::dvec3& w) { return radiance(w) * polynomials(w)[i]; });
    ambient.coefficients[i] = glm::vec3(a * projected / square);
  }
  expect_irradiance(ambient, radiance, 2e-3);
}

TEST(AmbientLight, IsNeverBelowZero) {
  Ambient ambient = Ambient::constant(0.1f);
  ambient.coefficients[1] = glm::vec3(1.0f, 0.0f, -1.0f);
  EXPECT_EQ(ambient.at({0, -1, 0}), glm::vec3(0.0f, 0.1f, 1.1f));
}

}  // namespace
}  // namespace chandelier
