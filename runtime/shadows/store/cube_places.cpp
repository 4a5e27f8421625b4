// SPDX-License-Identifier: Apache-2.0
#include "shadows/store/cube_places.h"

#include <array>
#include <stdexcept>
#include <string>

namespace chandelier {
namespace {

std::array<CubePlace, 4> quarters(const CubePlace& whole) {
  const uint32_t half = whole.size_px / 2;
  return {{{whole.cube, whole.top_px, whole.left_px, half},
           {whole.cube, whole.top_px, whole.left_px + half, half},
           {whole.cube, whole.top_px + half, whole.left_px, half},
           {whole.cube, whole.top_px + half, whole.left_px + half, half}}};
}

// The square of twice the size that it is a quarter of.
CubePlace whole_of(const CubePlace& quarter) {
  const uint32_t size_px = 2 * quarter.size_px;
  return {quarter.cube, quarter.top_px / size_px * size_px, quarter.left_px / size_px * size_px, size_px};
}

}  // namespace

std::optional<CubePlace> CubePlaces::take(uint32_t size_px) {
  if (size_px == 0 || size_px > layer_size_px_)
    throw std::invalid_argument("a shadow map of " + std::to_string(size_px) + " texels in layers of " +
                                std::to_string(layer_size_px_));
  size_t level = 0;
  for (uint32_t side = layer_size_px_; side % 2 == 0 && side / 2 >= size_px; side /= 2) ++level;
  if (free_.size() <= level) free_.resize(level + 1);
  return take_at(level);
}

std::optional<CubePlace> CubePlaces::take_at(size_t level) {
  if (!free_[level].empty()) return free_[level].extract(free_[level].begin()).value();
  if (level == 0)
    return used_cubes_ < cubes_ ? std::optional(CubePlace{used_cubes_++, 0, 0, layer_size_px_}) : std::nullopt;
  const std::optional<CubePlace> whole = take_at(level - 1);
  if (!whole) return std::nullopt;
  const auto parts = quarters(*whole);
  free_[level].insert(parts.begin() + 1, parts.end());
  return parts[0];
}

void CubePlaces::give_back(const CubePlace& place) {
  CubePlace freed = place;
  size_t level = 0;
  for (uint32_t side = layer_size_px_; side > place.size_px; side /= 2) ++level;
  for (; level > 0; --level) {
    const auto parts = quarters(whole_of(freed));
    size_t free = 0;
    for (const CubePlace& part : parts) free += part == freed || free_[level].contains(part);
    if (free < parts.size()) break;
    for (const CubePlace& part : parts) free_[level].erase(part);
    freed = whole_of(freed);
  }
  free_[level].insert(freed);
}

}  // namespace chandelier
