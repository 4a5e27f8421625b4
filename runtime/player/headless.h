// SPDX-License-Identifier: Apache-2.0
// Draws into a file, without a display.
#pragma once

#include "player/camera.h"
#include "player/options.h"

namespace chandelier::player {

/// Draws options.frames timed frames after warming up, writes the last one and, where asked, the stats. Throws.
void run_headless(const Options& options, const NamedCamera& camera, const pack::File& pack, const gpu::Device& device,
                  Renderer& renderer, const VisibilitySource& visibility);

}  // namespace chandelier::player
