// SPDX-License-Identifier: Apache-2.0
#include "lights/surroundings.h"

namespace chandelier {

lights::Walls& Surroundings::walls() {
  if (!rays_) rays_.emplace(pack_);
  if (!walls_) walls_.emplace(pack_, *rays_);
  return *walls_;
}

ErrorDriven& Surroundings::by_error() {
  if (!by_error_) by_error_.emplace(pack_);
  return *by_error_;
}

}  // namespace chandelier
