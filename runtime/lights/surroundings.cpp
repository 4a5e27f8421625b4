// SPDX-License-Identifier: Apache-2.0
#include "lights/surroundings.h"

namespace chandelier {

const rays::PackRays& Surroundings::rays() {
  if (!rays_) rays_.emplace(pack_);
  return *rays_;
}

lights::Walls& Surroundings::walls() {
  if (!walls_) walls_.emplace(pack_, rays());
  return *walls_;
}

ErrorDriven& Surroundings::by_error() {
  if (!by_error_) by_error_.emplace(pack_, rays());
  return *by_error_;
}

}  // namespace chandelier
