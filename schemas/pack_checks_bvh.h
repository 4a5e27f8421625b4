// SPDX-License-Identifier: Apache-2.0
// The rules between fields of the hierarchies over batches, instances and triangles.
#pragma once

#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// For a view that validate() found no fault in, and whose batches are whole triangles. Returns one line that names the
/// first fault, or an empty string. Linear in the view: trees and leaves lie one after another, so that none is read
/// twice.
[[nodiscard]] std::string bvh_fault(const View& view);

}  // namespace chandelier::pack
