// SPDX-License-Identifier: Apache-2.0
// Pass: animated nodes, their animations and their skins.
#pragma once

#include "../scene.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills nodes, animations, animation_channels, animation_times, animation_values, skins and joints. Consecutive
/// channels with equal times share one copy of the times. Throws Error.
void make_animations(const Scene& scene, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
