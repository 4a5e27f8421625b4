// SPDX-License-Identifier: Apache-2.0
// Pass: places each batch in each instance, with its box in the world.
#pragma once

#include "../scene.h"
#include "batches.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills instances and batch_instances; needs batches and materials. Throws Error.
void make_instances(const Scene& scene, const std::vector<MeshRecords>& meshes, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
