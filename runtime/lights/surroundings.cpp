// SPDX-License-Identifier: Apache-2.0
#include "lights/surroundings.h"

namespace chandelier {

// As all instances stand now.
const rays::PackRays& Surroundings::rays() {
  if (!rays_) rays_.emplace(world_.pack());
  if (world_.instances_version() == instances_) return *rays_;
  for (const InstanceId id : world_.instances_changed_since(instances_))
    rays_->set_transform(id, world_.instances()[id].world_from_local);
  instances_ = world_.instances_version();
  return *rays_;
}

lights::Walls& Surroundings::walls() {
  const rays::PackRays& through = rays();
  if (!walls_) walls_.emplace(world_, through);
  return *walls_;
}

ErrorDriven& Surroundings::by_error() {
  const rays::PackRays& through = rays();
  if (!by_error_) by_error_.emplace(world_, through, materials_of_);
  return *by_error_;
}

}  // namespace chandelier
