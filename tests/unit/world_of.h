// SPDX-License-Identifier: Apache-2.0
// A world that holds nothing but lights.
#pragma once

#include <span>

#include "world/world.h"

namespace chandelier::test {

inline World world_of(std::span<const pack::Light> lights, const WorldRoom& room = {}) {
  pack::View pack;
  pack.lights = lights;
  return World(pack, room);
}

}  // namespace chandelier::test
