// SPDX-License-Identifier: Apache-2.0
// Pictures that would be black, and what to do about them. All is said on stderr.
#pragma once

#include "player/options.h"

namespace chandelier::player {

/// The headlight where --headlight auto leaves it to the pack: on where nothing else lights it.
float automatic_headlight(const Options& options, const pack::View& pack);

/// Warns of a pack without lights, unless --ambient or a headlight that is on shows that they know who asked. `options`
/// with the headlight as it will be.
void warn_of_no_lights(const Options& asked, const Options& options, const pack::View& pack);

/// Is there next to nothing to be seen, as on a screen?
bool is_black(const Picture& picture);
/// Warns of a black picture, unless warn_of_no_lights() has said why.
void warn_of_black(const Options& options, const pack::View& pack, const Picture& picture);

}  // namespace chandelier::player
