// SPDX-License-Identifier: Apache-2.0
// What each pass draws: one work group. Where order is kept, first the place of each pair's draws.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull_bindings.glsl"

layout(local_size_x = PLAN_GROUP_SIZE) in;
layout(constant_id = 0) const uint keep_order = 0u;

shared uint sums[2][PLAN_GROUP_SIZE];
shared uint passes;

// The sum of `value` over all threads up to this one.
uint sum_up_to_thread(uint value) {
  uint thread = gl_LocalInvocationIndex;
  uint from = 0u;
  sums[0][thread] = value;
  barrier();
  uint step = 1u;
  do {
    uint sum = sums[from][thread] + (thread >= step ? sums[from][thread - step] : 0u);
    from = 1u - from;
    sums[from][thread] = sum;
    barrier();
    step *= 2u;
  } while (step < PLAN_GROUP_SIZE);
  return sums[from][thread];
}

// Pairs are in their blocks' order, and blocks in their lists'.
void place_pairs() {
  uint thread = gl_LocalInvocationIndex;
  uint before = 0u;
  uint first = 0u;
  if (cull.block_count > 0u) do {
    uint number = first + thread;
    uint count = number < cull.block_count ? pairs[number].draw_count : 0u;
    uint sum = sum_up_to_thread(count);
    if (number < cull.block_count) {
      uint place = before + sum - count;
      uint list = blocks[number].list;
      pairs[number].first_draw = place;
      if (slots[list].first_block == number) totals[1u + cull.list_count + list] = place;
    }
    if (thread == PLAN_GROUP_SIZE - 1u) passes = before + sum;
    barrier();
    before = passes;
    barrier();
    first += PLAN_GROUP_SIZE;
  } while (first < cull.block_count);
  memoryBarrierBuffer();
  barrier();
  for (uint list = thread; list < cull.list_count; list += PLAN_GROUP_SIZE)
    totals[1u + list] = (list + 1u < cull.list_count ? draws_before_list(list + 1u) : before) - draws_before_list(list);
  memoryBarrierBuffer();
  barrier();
}

void main() {
  uint thread = gl_LocalInvocationIndex;
  if (keep_order != 0u) place_pairs();
  if (thread == 0u) passes = 1u;
  barrier();
  for (uint list = thread; list < cull.list_count; list += PLAN_GROUP_SIZE) {
    uint capacity = slots[list].capacity;
    atomicMax(passes, (draws_of_list(list) + capacity - 1u) / capacity);
  }
  barrier();
  for (uint i = thread; i < cull.pass_count * cull.list_count; i += PLAN_GROUP_SIZE) {
    uint list = i % cull.list_count;
    uint first = i / cull.list_count * slots[list].capacity, total = draws_of_list(list);
    draw_counts[i] = total > first ? min(total - first, slots[list].capacity) : 0u;
  }
  for (uint i = thread; i < cull.pass_count; i += PLAN_GROUP_SIZE) {
    append_groups[3u * i] = i < passes ? min(totals[0], CULL_GROUPS) : 0u;
    append_groups[3u * i + 1u] = append_groups[3u * i + 2u] = 1u;
  }
  if (thread == 0u) counters[cull.group].further_passes = passes - 1u;
}
