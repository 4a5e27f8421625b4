// SPDX-License-Identifier: Apache-2.0
// The report that --json writes; schemas/bake_report.schema.json says what is in it.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "options.h"
#include "report.h"

namespace chandelier::baker {

/// The results of a finished bake.
struct Outcome {
  Report report;
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files_read;
  std::map<std::string, bool> cache_loads;  // each entry, and whether it was there
  uint64_t triangles = 0;                   // stored
  uint64_t instanced_triangles = 0;         // as drawn
  uint64_t batches = 0;
  uint64_t images = 0;
  uint64_t lights = 0;
  uint64_t pack_bytes = 0;
  double seconds = 0;  // from start to end
};

std::string report_json(const Options& options, const Outcome& outcome);

}  // namespace chandelier::baker
