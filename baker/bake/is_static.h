// SPDX-License-Identifier: Apache-2.0
// Which batch instances are static, and so part of the static hierarchies and voxels.
#pragma once

#include "pack_schema.h"

namespace chandelier::baker {

inline bool is_static(const pack::Contents& pack, const pack::BatchInstance& draw) {
  return pack.instances[draw.instance].dynamic == 0;
}

}  // namespace chandelier::baker
