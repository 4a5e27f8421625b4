// SPDX-License-Identifier: Apache-2.0
// The rules between fields of lights and their hierarchy.
#pragma once

#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// For a view that passed validate(): one line that names the first fault, or an empty string.
[[nodiscard]] std::string light_fault(const View& view);

}  // namespace chandelier::pack
