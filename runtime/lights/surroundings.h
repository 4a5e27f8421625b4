// SPDX-License-Identifier: Apache-2.0
// What selections look up around a world's lights, made when one first asks, kept from frame to frame, and brought up
// to date where the world has changed.
#pragma once

#include <optional>

#include "lights/error_driven.h"
#include "lights/walls.h"

namespace chandelier {

class Surroundings {
 public:
  /// `world` must outlive this.
  explicit Surroundings(const World& world, MeanMaterialsOf materials_of = mean_materials)
      : world_(world), materials_of_(materials_of) {}
  Surroundings(const Surroundings&) = delete;

  lights::Walls& walls();
  ErrorDriven& by_error();
  /// An error search that ran beside the frames has ended, and nothing was selected by error since: a selection that
  /// was provisional may now be otherwise.
  bool has_news() const { return by_error_ && by_error_->has_news(); }

 private:
  const rays::PackRays& rays();

  const World& world_;
  MeanMaterialsOf materials_of_;
  std::optional<rays::PackRays> rays_;
  Version instances_ = 0;  // that rays_ stand as
  std::optional<lights::Walls> walls_;
  std::optional<ErrorDriven> by_error_;
};

}  // namespace chandelier
