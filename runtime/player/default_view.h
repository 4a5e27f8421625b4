// SPDX-License-Identifier: Apache-2.0
// Where a pack without cameras is looked at from: a place that sees something lit.
#pragma once

#include "player/camera.h"

namespace chandelier::player {

/// All of the scene from a corner above, if a tenth of what is seen from there is lit. Else all but sky and lamps,
/// whose own colour is what is seen; else from inside, standing near a light. Where none of them sees more, all of the
/// scene. Where there are no lights, every surface that a light could change counts as lit. The same pack gets the same
/// view. Rays on the CPU find it: no more of them in a large scene than in a small one.
NamedCamera default_view(const pack::View& pack, float aspect);

}  // namespace chandelier::player
