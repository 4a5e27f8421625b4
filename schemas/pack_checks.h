// SPDX-License-Identifier: Apache-2.0
// The rules of a pack that concern more than one field.
#pragma once

#include <cstddef>
#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// validate() and then the rules between fields. Returns one line that names the first fault, or an empty string.
/// Big packs are checked in at most `most_threads` threads; 0: as many as there are cores.
[[nodiscard]] std::string check(const View& view, size_t most_threads = 0);

/// The first rule that a light by itself breaks, ".priority: 256 is above 255", or an empty string. Its voxel, node and
/// name are not looked at.
[[nodiscard]] std::string light_fault(const Light& light);

}  // namespace chandelier::pack
