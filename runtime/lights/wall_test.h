// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace chandelier::lights {

/// How walls between lights are found.
enum class WallTest : uint32_t {
  none,    // not at all: the paper's selection
  voxels,  // a cell of the pack's voxels that holds triangles lies between, the lights' own cells left out
  rays,    // a ray meets something, unless it is so small that one can step around it
};

}  // namespace chandelier::lights
