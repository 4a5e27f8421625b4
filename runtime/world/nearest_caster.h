// SPDX-License-Identifier: Apache-2.0
// How near to a place something throws a shadow: what a shadow map's near plane depends on (light_near.h).
#pragma once

#include <glm/glm.hpp>

namespace chandelier {

class World;

/// Distance of the nearest triangle that throws a shadow, where all instances stand now; `most_m`, or the distance
/// beyond which no near plane changes, where none is nearer. Rounded down. Metres.
float nearest_caster_m(const World& world, const glm::vec3& at_ws, float most_m);

}  // namespace chandelier
