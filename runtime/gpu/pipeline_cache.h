// SPDX-License-Identifier: Apache-2.0
// The compute pipelines that a device has made: drivers take seconds to compile the largest, and several renderers may
// need the same.
#pragma once

#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "gpu/pipelines.h"

namespace chandelier::gpu {

struct PipelineCache {
  /// A shader's code, and its constants by number with their values.
  using Key = std::pair<const uint32_t*, std::vector<std::pair<uint32_t, uint32_t>>>;

  std::mutex mutex;  // held while a pipeline is looked for and made
  std::map<Key, Pipeline> compute;
};

}  // namespace chandelier::gpu
