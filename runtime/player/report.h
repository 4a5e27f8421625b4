// SPDX-License-Identifier: Apache-2.0
// A comparison as one HTML page.
#pragma once

#include <string>
#include <string_view>

#include "player/compare.h"

namespace chandelier::player {

/// `text` with & < > " ' escaped, for element content and quoted attributes.
std::string escape_html(std::string_view text);

/// The page; it links the comparison's images beside it and needs nothing else.
std::string report_html(const Comparison& comparison);

}  // namespace chandelier::player
