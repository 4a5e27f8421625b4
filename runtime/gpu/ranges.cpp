// SPDX-License-Identifier: Apache-2.0
#include "gpu/ranges.h"

#include <iterator>

namespace chandelier::gpu {

std::optional<uint64_t> Ranges::take(uint64_t size, uint64_t alignment) {
  for (auto gap = free_.begin(); gap != free_.end(); ++gap) {
    const auto [begin, length] = *gap;
    const uint64_t offset = (begin + alignment - 1) / alignment * alignment;
    const uint64_t skipped = offset - begin;
    if (length < skipped || length - skipped < size) continue;
    const uint64_t rest = length - skipped - size;
    free_.erase(gap);
    if (skipped) free_.emplace(begin, skipped);
    if (rest) free_.emplace(offset + size, rest);
    return offset;
  }
  return std::nullopt;
}

void Ranges::give_back(uint64_t offset, uint64_t size) {
  auto gap = free_.emplace(offset, size).first;
  const auto next = std::next(gap);
  if (next != free_.end() && next->first == gap->first + gap->second) {
    gap->second += next->second;
    free_.erase(next);
  }
  if (gap == free_.begin()) return;
  const auto before = std::prev(gap);
  if (before->first + before->second != gap->first) return;
  before->second += gap->second;
  free_.erase(gap);
}

}  // namespace chandelier::gpu
