// SPDX-License-Identifier: Apache-2.0
// How a search that runs beside the frames is told that nobody waits for its answer any more.
#pragma once

#include <stop_token>

namespace chandelier {

struct SearchStopped {};

/// Throws SearchStopped.
inline void stop_if_asked(const std::stop_token& stop) {
  if (stop.stop_requested()) throw SearchStopped{};
}

}  // namespace chandelier
