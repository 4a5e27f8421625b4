// SPDX-License-Identifier: Apache-2.0
// What tests expect of any pack's voxels, by cutting each triangle with the planes of the cells around it.
#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "pack_schema.h"

namespace chandelier::baker::test {

/// A placed triangle: instance and vertices, as drawn.
using Placed = std::array<uint32_t, 4>;

/// {placed triangle: {cell: how often}}; the count of cells stands for no cell. Runs must have the triangle's material.
std::map<Placed, std::map<uint32_t, int>> cells_of_triangles(const pack::Contents& pack);

/// Every static triangle is in no cell if it surely overlaps more than two, else in all that it surely overlaps, and in
/// none that it surely does not; as often as it is drawn. "Surely" leaves out what rounding decides.
void expect_separate(const pack::Contents& pack);

/// Each clipped triangle is in its cell, to a float; their area is that of the input; no vertex of a cell comes twice.
void expect_clipped(const pack::Contents& pack);

}  // namespace chandelier::baker::test
