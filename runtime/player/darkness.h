// SPDX-License-Identifier: Apache-2.0
// Warnings on stderr about pictures that would be black, with remedies.
#pragma once

#include "player/options.h"

namespace chandelier::player {

/// The strength for --headlight auto: on if nothing else lights the pack.
float automatic_headlight(const Options& options, const pack::View& pack);

/// Warns of a pack without lights, unless --ambient or a headlight that is on shows that the user knows. `options` has
/// the headlight that will be used.
void warn_of_no_lights(const Options& asked, const Options& options, const pack::View& pack);

/// Whether nearly nothing of the shown picture is visible.
bool is_black(const Picture& picture);
/// Warns of a black picture, unless warn_of_no_lights() has said why.
void warn_of_black(const Options& options, const pack::View& pack, const Picture& picture);

}  // namespace chandelier::player
