// SPDX-License-Identifier: Apache-2.0
#include "shadows/cull/count_casters.h"

#include <algorithm>
#include <vector>

#include "shadows/cull/draw_lists.h"
#include "stages/cull.h"

namespace chandelier {
namespace {

// Draws of each list in some views.
template <typename Answer>
std::vector<uint64_t> count_lists(std::span<const frame::ShadowView> views, const DrawLists& lists, const World& world,
                                  uint64_t& triangles) {
  std::vector<uint64_t> draws(lists.lists.size());
  for (const frame::ShadowView& view : views) {
    const Answer answer(view);
    for (const frame::BatchBlock& block : lists.blocks)
      for (const uint32_t number : std::span(lists.order).subspan(block.first, block.count)) {
        const pack::BatchInstance& candidate = world.batch_instances()[number];
        if (!answer.survives(candidate)) continue;
        ++draws[block.list];
        triangles += world.pack().batches[candidate.batch].index_count / 3;
      }
  }
  return draws;
}

template <typename Answer>
CasterCounts count(std::span<const frame::ShadowView> views, std::span<const ViewGroup> groups, uint64_t most_draws,
                   const World& world) {
  const DrawLists lists = lists_for_shadows(world.pack());
  CasterCounts counts;
  for (const ViewGroup& group : groups) {
    const auto draws = count_lists<Answer>(views.subspan(group.first, group.count), lists, world, counts.triangles);
    const auto slots = divide_draws(lists.lists, group.count, most_draws, most_draws);
    uint64_t passes = 1;
    for (size_t i = 0; i < draws.size(); ++i) {
      counts.draws += draws[i];
      passes = std::max(passes, (draws[i] + slots[i].capacity - 1) / slots[i].capacity);
    }
    counts.further_passes += passes - 1;
  }
  return counts;
}

}  // namespace

CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, std::span<const ViewGroup> groups,
                           uint64_t most_draws, const World& world) {
  return with_cull(cull, [&]<typename Answer>() { return count<Answer>(views, groups, most_draws, world); });
}

}  // namespace chandelier
