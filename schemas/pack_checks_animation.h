// SPDX-License-Identifier: Apache-2.0
// The rules between fields of nodes, animations and skins.
#pragma once

#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// The first fault among nodes, animations and skins, or an empty string. Every index and run is valid already.
[[nodiscard]] std::string animation_fault(const View& view);

}  // namespace chandelier::pack
