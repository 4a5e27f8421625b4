// SPDX-License-Identifier: Apache-2.0
// What bake_geometry() makes, kept in a cache.
#pragma once

#include <cstddef>
#include <string>

#include "../cache.h"
#include "../report.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills what bake_geometry() fills, and adds its passes to the report; false where the cache cannot.
bool load_geometry(Cache& cache, const std::string& entry, Report& report, Strings& strings, pack::Contents& pack);

/// `first_pass`: of the report, where bake_geometry() began.
void store_geometry(Cache& cache, const std::string& entry, const Report& report, size_t first_pass,
                    const pack::Contents& pack);

}  // namespace chandelier::baker
