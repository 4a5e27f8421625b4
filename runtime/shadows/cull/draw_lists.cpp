// SPDX-License-Identifier: Apache-2.0
#include "shadows/cull/draw_lists.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <numeric>

#include "throws_shadow.h"

namespace chandelier {
namespace {

uint32_t material_of(const pack::View& pack, uint32_t batch_instance) {
  return pack.batches[pack.batch_instances[batch_instance].batch].material;
}

// Splits `members` into blocks of a new list.
void add_list(DrawLists& lists, uint32_t material, const std::vector<uint32_t>& members) {
  const auto number = static_cast<uint32_t>(lists.lists.size());
  const auto count = static_cast<uint32_t>(members.size());
  lists.lists.push_back(
      {.material = material, .batch_instances = count, .first_block = static_cast<uint32_t>(lists.blocks.size())});
  const auto start = static_cast<uint32_t>(lists.order.size());
  for (uint32_t first = 0; first < count; first += frame::cull_group_size)
    lists.blocks.push_back(
        {.first = start + first, .count = std::min(frame::cull_group_size, count - first), .list = number});
  lists.order.insert(lists.order.end(), members.begin(), members.end());
}

// Bits 0 to 9 to every third place.
uint32_t spread_bits(uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000FF;
  bits = (bits | bits << 8) & 0x0300F00F;
  bits = (bits | bits << 4) & 0x030C30C3;
  return (bits | bits << 2) & 0x09249249;
}

// Orders by place along a Morton curve through the members' own bounds.
void sort_by_place(const pack::View& pack, std::vector<uint32_t>& members) {
  const auto middle = [&](uint32_t member) {
    const pack::BatchInstance& placed = pack.batch_instances[member];
    return 0.5f * placed.bounds_min_ws + 0.5f * placed.bounds_max_ws;
  };
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const uint32_t member : members) {
    low = glm::min(low, middle(member));
    high = glm::max(high, middle(member));
  }
  const glm::vec3 scale = 1023.0f / glm::max(high - low, glm::vec3(1e-6f));
  std::vector<std::pair<uint32_t, uint32_t>> codes;
  for (const uint32_t member : members) {
    const glm::uvec3 cell(glm::clamp((middle(member) - low) * scale, 0.0f, 1023.0f));
    codes.emplace_back(spread_bits(cell.x) | spread_bits(cell.y) << 1 | spread_bits(cell.z) << 2, member);
  }
  std::ranges::sort(codes);
  std::ranges::transform(codes, members.begin(), [](const auto& code) { return code.second; });
}

}  // namespace

DrawLists lists_by_material(const pack::View& pack) {
  DrawLists lists;
  const auto count = static_cast<uint32_t>(pack.batch_instances.size());
  uint32_t first = 0;
  while (first < count) {
    const uint32_t material = material_of(pack, first);
    uint32_t end = first + 1;
    while (end < count && material_of(pack, end) == material) ++end;
    std::vector<uint32_t> members(end - first);
    std::iota(members.begin(), members.end(), first);
    add_list(lists, material, members);
    first = end;
  }
  return lists;
}

DrawLists lists_for_shadows(const pack::View& pack) {
  std::vector<uint32_t> opaque;
  std::vector<std::pair<uint32_t, std::vector<uint32_t>>> masked;
  for (uint32_t i = 0; i < pack.batch_instances.size(); ++i) {
    if (!throws_shadow(pack, pack.batch_instances[i])) continue;
    const uint32_t material = material_of(pack, i);
    if (pack.materials[material].alpha_mode != pack::AlphaMode::mask) {
      opaque.push_back(i);
      continue;
    }
    if (masked.empty() || masked.back().first != material) masked.push_back({material, {}});
    masked.back().second.push_back(i);
  }
  DrawLists lists;
  if (!opaque.empty()) {
    sort_by_place(pack, opaque);
    add_list(lists, pack::none, opaque);
  }
  for (auto& [material, members] : masked) {
    sort_by_place(pack, members);
    add_list(lists, material, members);
  }
  return lists;
}

uint64_t most_views(uint64_t batch_instances, uint64_t most_draws) {
  return most_draw_passes * most_draws / std::max<uint64_t>(1, batch_instances);
}

std::vector<frame::DrawSlots> divide_draws(const std::vector<DrawList>& lists, uint64_t views, uint64_t most_draws,
                                           uint64_t most_of_list) {
  uint64_t batch_instances = 0;
  for (const DrawList& list : lists) batch_instances += list.batch_instances;
  std::vector<frame::DrawSlots> slots;
  uint64_t first = 0;
  for (const DrawList& list : lists) {
    const uint64_t share = (most_draws * list.batch_instances + batch_instances - 1) / batch_instances;
    const uint64_t capacity = std::max<uint64_t>(1, std::min({share, most_of_list, list.batch_instances * views}));
    slots.push_back({.first = static_cast<uint32_t>(first),
                     .capacity = static_cast<uint32_t>(capacity),
                     .first_block = list.first_block});
    first += capacity;
  }
  return slots;
}

uint32_t passes_at_most(const std::vector<DrawList>& lists, const std::vector<frame::DrawSlots>& slots,
                        uint64_t views) {
  uint64_t passes = 1;
  for (size_t i = 0; i < lists.size(); ++i)
    passes = std::max(passes, (lists[i].batch_instances * views + slots[i].capacity - 1) / slots[i].capacity);
  return static_cast<uint32_t>(passes);
}

}  // namespace chandelier
