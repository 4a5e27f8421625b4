// SPDX-License-Identifier: Apache-2.0
// Pass: equal vertices of a primitive become one.
#pragma once

#include "../scene.h"
#include "packed.h"

namespace chandelier::baker {

/// Byte by byte, with joints and weights; the first of equal vertices stays, in the same order.
void weld(Primitive& primitive);
void weld(PackedPrimitive& primitive);

}  // namespace chandelier::baker
