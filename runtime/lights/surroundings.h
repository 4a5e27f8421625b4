// SPDX-License-Identifier: Apache-2.0
// What selections of lights look up around a pack's lights, made when one first asks and remembered from frame to
// frame.
#pragma once

#include <optional>

#include "lights/error_driven.h"
#include "lights/walls.h"

namespace chandelier {

class Surroundings {
 public:
  /// What `pack` points to must outlive this.
  explicit Surroundings(const pack::View& pack) : pack_(pack) {}
  Surroundings(const Surroundings&) = delete;

  lights::Walls& walls();
  ErrorDriven& by_error();

 private:
  const rays::PackRays& rays();

  pack::View pack_;
  std::optional<rays::PackRays> rays_;
  std::optional<lights::Walls> walls_;
  std::optional<ErrorDriven> by_error_;
};

}  // namespace chandelier
