// SPDX-License-Identifier: Apache-2.0
// How many threads --threads allows where oneTBB does not run the work.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task.h>

#include <cstddef>

namespace chandelier::baker {

/// The number of threads that a call from here may use: oneTBB's limit; inside a oneTBB task, where other tasks run
/// already, 1.
inline size_t most_threads() {
  if (tbb::task::current_context()) return 1;
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace chandelier::baker
