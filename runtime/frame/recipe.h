// SPDX-License-Identifier: Apache-2.0
// Which recipes can be rendered. What a recipe is, recipe_schema.h says, which is made from schemas/frame.xml.
#pragma once

#include "recipe_schema.h"

namespace chandelier {

/// Why this recipe cannot be rendered, or nothing where it can.
std::optional<std::string> refusal(const Recipe& recipe);

}  // namespace chandelier
