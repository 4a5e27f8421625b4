// SPDX-License-Identifier: Apache-2.0
// --predict: what a frame will cost. schemas/prediction.schema.json describes the JSON.
#pragma once

#include "player/camera.h"
#include "player/options.h"

namespace chandelier::player {

/// Prints a table on stdout and, where asked, writes the JSON. Opens no device. Throws.
void run_prediction(const Options& options, const NamedCamera& camera, const pack::File& pack, const World& world);

}  // namespace chandelier::player
