// SPDX-License-Identifier: Apache-2.0
// EXT_meshopt_compression: compressed buffer views.
#pragma once

#include "gltf.h"

namespace chandelier::baker {

/// Fills `decoded_views`, in parallel. A view that cannot be decoded holds an error, which is thrown when something
/// reads it. Throws Error if all views together need more than 16 GiB.
void decode_meshopt_views(Gltf& gltf);

}  // namespace chandelier::baker
