// SPDX-License-Identifier: Apache-2.0
// Keeps the result of bake_geometry() in the cache.
#pragma once

#include <cstddef>
#include <string>

#include "../cache.h"
#include "../report.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Loads the result of bake_geometry() and adds its passes to the report. Returns false if the cache has no usable
/// entry.
bool load_geometry(Cache& cache, const std::string& entry, Report& report, Strings& strings, pack::Contents& pack);

/// `first_pass`: the report's number of the first pass of bake_geometry().
void store_geometry(Cache& cache, const std::string& entry, const Report& report, size_t first_pass,
                    const pack::Contents& pack);

}  // namespace chandelier::baker
