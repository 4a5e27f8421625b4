// SPDX-License-Identifier: Apache-2.0
// The rules between fields of the voxel sections.
#pragma once

#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// For a view that validate() found no fault in. Returns one line that names the first fault, or an empty string.
/// Linear in the view: runs and indices lie one after another, so that none is read twice.
[[nodiscard]] std::string voxel_fault(const View& view);

}  // namespace chandelier::pack
