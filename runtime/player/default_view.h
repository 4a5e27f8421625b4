// SPDX-License-Identifier: Apache-2.0
// The camera for a pack without cameras: a view of something lit.
#pragma once

#include "player/camera.h"

namespace chandelier::player {

/// The whole scene from a corner above, if a tenth of the visible surfaces are lit. Else the same without unlit and
/// emissive surfaces (sky, lamps). Else a view from inside, near a light. If none of these shows more, the first.
/// Without lights, every surface that a light could change counts as lit. The same pack gets the same view. Rays on the
/// CPU decide; their number does not depend on the size of the scene.
NamedCamera default_view(const pack::View& pack, float aspect);

}  // namespace chandelier::player
