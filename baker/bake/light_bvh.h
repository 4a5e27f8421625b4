// SPDX-License-Identifier: Apache-2.0
// Pass: spheres around lights, which a shader walks without a stack to find the lights that reach a point.
#pragma once

#include <span>
#include <vector>

#include "pack_schema.h"

namespace chandelier::baker {

/// Nodes over the point and spot lights with their bounds, each in one leaf. A node's sphere holds the bounds of all
/// lights below it, if not always the spheres of its children.
std::vector<pack::LightBvhNode> build_light_bvh(std::span<const pack::Light> lights);

}  // namespace chandelier::baker
