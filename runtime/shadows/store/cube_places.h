// SPDX-License-Identifier: Apache-2.0
// Which squares of a pool of cubes are free. A cube is six layers of one size; a map has the same square of all six, of
// the layers' size or of a half, a quarter … of it.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

namespace chandelier {

struct CubePlace {
  uint32_t cube = 0;
  uint32_t top_px = 0;
  uint32_t left_px = 0;
  uint32_t size_px = 0;

  auto operator<=>(const CubePlace&) const = default;
};

/// A buddy allocator: a square is quartered where a smaller one is asked for, and put together again when all four
/// quarters are free.
class CubePlaces {
 public:
  CubePlaces(uint32_t layer_size_px, uint32_t cubes) : layer_size_px_(layer_size_px), cubes_(cubes), free_(1) {}

  /// The first free square that holds `size_px`; nothing where there is none. Throws std::invalid_argument where layers
  /// are smaller.
  std::optional<CubePlace> take(uint32_t size_px);
  /// What take() returned.
  void give_back(const CubePlace& place);

  /// Cubes of which anything was ever taken: the first ones.
  uint32_t used_cubes() const { return used_cubes_; }

 private:
  std::optional<CubePlace> take_at(size_t level);

  uint32_t layer_size_px_;
  uint32_t cubes_;
  uint32_t used_cubes_ = 0;
  std::vector<std::set<CubePlace>> free_;  // by level: whole layers, halves, quarters …
};

}  // namespace chandelier
