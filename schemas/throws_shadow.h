// SPDX-License-Identifier: Apache-2.0
// What casts a shadow: one rule for the baker, shadow maps, rays and predictions.
#pragma once

#include "pack_schema.h"

namespace chandelier::pack {

/// Whether a batch instance casts a shadow: neither its instance nor its material is shadowless. `pack`: a View, or
/// Contents.
template <typename Pack>
bool throws_shadow(const Pack& pack, const BatchInstance& placed) {
  return pack.instances[placed.instance].shadowless == 0 &&
         pack.materials[pack.batches[placed.batch].material].shadowless == 0;
}

}  // namespace chandelier::pack
