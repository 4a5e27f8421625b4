// SPDX-License-Identifier: Apache-2.0
// Pass: what moves, with its keys and its bind pose.
#pragma once

#include "../scene.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills nodes, animations, animation_channels, animation_times, animation_values, skins and joints. Channels that
/// follow each other and have the same times share them. Throws Error.
void make_animations(const Scene& scene, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
