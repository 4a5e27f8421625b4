// SPDX-License-Identifier: Apache-2.0
// EXT_meshopt_compression: compressed buffer views.
#pragma once

#include "gltf.h"

namespace chandelier::baker {

/// Fills `decoded_views`, side by side. What cannot be decoded has an error, told where something reads it. Throws
/// Error where all views together would need more than 16 GiB.
void decode_meshopt_views(Gltf& gltf);

}  // namespace chandelier::baker
