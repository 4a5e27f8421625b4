// SPDX-License-Identifier: Apache-2.0
// Pass: equal vertices become one; triangles with a repeated vertex go.
#pragma once

#include "../scene.h"

namespace chandelier::baker {

void weld(Primitive& primitive);

}  // namespace chandelier::baker
