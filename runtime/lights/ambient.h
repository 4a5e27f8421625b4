// SPDX-License-Identifier: Apache-2.0
// Light from all around that casts no shadow, as a function of direction.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace chandelier {

/// Irradiance over pi of a surface, by its normal: what a white Lambert surface there reflects. Spherical harmonics up
/// to the second degree, which are within a percent of what distant light of any kind gives (Ramamoorthi and Hanrahan
/// 2001). Each coefficient has its function's constant in it, so that the first one alone is light of one radiance from
/// everywhere; of a radiance L(w) it is, where B_i are the polynomials in ambient.cpp and l their degree,
///
///     a_l k_i^2 ∫ L(w) B_i(w) dw,  a = 1, 2/3, 1/4,  k_i^2 ∫ B_i(w)^2 dw = 1.
///
/// The same in shading/ambient.glsl.
struct Ambient {
  std::array<glm::vec3, 9> coefficients{};

  /// The same radiance from everywhere.
  static Ambient constant(float radiance);
  /// `up` from straight above (+y), `down` from straight below, linear in the sine of the height between.
  static Ambient between(float up, float down);

  /// `normal_ws`: unit length. Not below 0.
  glm::vec3 at(const glm::vec3& normal_ws) const;
  /// It is the same from everywhere.
  bool is_constant() const;
  bool is_dark() const { return *this == Ambient{}; }

  bool operator==(const Ambient&) const = default;
};

}  // namespace chandelier
