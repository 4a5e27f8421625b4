// SPDX-License-Identifier: Apache-2.0
// Passes: hierarchies over static batch instances and static instances.
#pragma once

#include "../report.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// Fills batch_bvh and batch_bvh_items from batch_instances.
void make_batch_bvh(PassReport& pass, pack::Contents& pack);

/// Fills instance_bvh and instance_bvh_items; an instance's box is that of its batch instances.
void make_instance_bvh(PassReport& pass, pack::Contents& pack);

}  // namespace chandelier::baker
