// SPDX-License-Identifier: Apache-2.0
// Finds equal elements of an array: the hash table of the geometry passes, on all cores.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// Returns for each of `count` elements the number of the first element that equals it. `hash(i)` must use all of its
/// 32 bits; `equal(i, j)` decides. Elements are distributed by hash to tables that fit the cache, one task per table,
/// in ascending order.
template <typename Hash, typename Equal>
std::vector<uint32_t> first_equal(size_t count, Hash hash, Equal equal) {
  constexpr uint32_t empty_slot = 0xFFFFFFFFu;
  constexpr size_t table_elements = 1 << 14;
  struct Keyed {
    uint32_t hash, element;
  };
  const int shift = 32 - std::clamp(static_cast<int>(std::bit_width(count / table_elements)), 0, 12);
  const auto table_of = [&](uint32_t h) { return shift == 32 ? 0 : h >> shift; };

  std::vector<uint32_t> first(count);  // holds the hashes until they are distributed
  tbb::parallel_for(size_t{0}, (count + 4095) / 4096, [&](size_t block) {
    for (size_t i = block * 4096; i < std::min(count, block * 4096 + 4096); ++i) first[i] = hash(i);
  });
  std::vector<size_t> end((size_t{1} << (32 - shift)) + 1, 0);
  for (const uint32_t h : first) ++end[table_of(h) + 1];
  for (size_t t = 1; t < end.size(); ++t) end[t] += end[t - 1];
  std::vector<Keyed> dealt(count);
  for (size_t i = 0; i < count; ++i) dealt[end[table_of(first[i])]++] = {first[i], static_cast<uint32_t>(i)};

  tbb::parallel_for(size_t{0}, end.size() - 1, [&](size_t t) {
    const size_t begin = t == 0 ? 0 : end[t - 1];  // distribution has moved each end to the end of its table
    const size_t size = std::bit_ceil(std::max<size_t>(2 * (end[t] - begin), 2));
    std::vector<Keyed> table(size, Keyed{0, empty_slot});
    for (size_t i = begin; i < end[t]; ++i) {
      const Keyed key = dealt[i];
      size_t slot = key.hash & (size - 1);
      while (table[slot].element != empty_slot &&
             (table[slot].hash != key.hash || !equal(table[slot].element, key.element))) {
        slot = (slot + 1) & (size - 1);
      }
      if (table[slot].element == empty_slot) table[slot] = key;
      first[key.element] = table[slot].element;
    }
  });
  return first;
}

/// Mixes all bits of the words of a record into 32 (the multiplier and the final mix are those of MurmurHash3).
inline uint32_t hash_words(const uint32_t* words, size_t count) {
  uint64_t h = count;
  for (size_t i = 0; i < count; ++i) h = (h ^ words[i]) * 0xff51afd7ed558ccdull, h ^= h >> 29;
  h *= 0xc4ceb9fe1a85ec53ull;
  return static_cast<uint32_t>(h >> 32);
}

}  // namespace chandelier::baker
