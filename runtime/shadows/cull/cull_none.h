// SPDX-License-Identifier: Apache-2.0
// Cull answer `none` on the CPU, for predictions: what cull_none.comp does.
#pragma once

#include "frame_schema.h"
#include "pack_schema.h"

namespace chandelier {

struct CullNone {
  explicit CullNone(const frame::ShadowView&) {}
  bool survives(const pack::BatchInstance&) const { return true; }
};

}  // namespace chandelier
