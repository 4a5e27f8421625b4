// SPDX-License-Identifier: Apache-2.0
// What every culling answer shares. The including shader defines `bool survives(ShadowView view, BatchInstance candidate)`.
// Where it defines TESTS_BLOCKS beforehand it also defines `bool may_survive(ShadowView view, BlockBox box)`, which must
// be true of a box within which anything survives. All steps must find the same: what is compared is `precise`.
#include "shadows/cull/cull_bindings.glsl"
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = CULL_GROUP_SIZE) in;
layout(constant_id = 0) const uint cull_step = 0u;
layout(constant_id = 1) const uint keep_order = 0u;  // 1: one view, whose draws keep the order of the batch instances
const uint FIND = 0u, COUNT = 1u;                    // cull.cpp:Step; else append

bool survives(ShadowView view, BatchInstance candidate);
#ifdef TESTS_BLOCKS
bool may_survive(ShadowView view, BlockBox box);
#else
bool may_survive(ShadowView view, BlockBox box) { return true; }
#endif

// Which of a pair's views a batch instance is drawn in.
uint surviving_views(BlockPair pair, BatchInstance candidate) {
  uint bits = 0u;
  uint left = pair.view_bits;
  if (left != 0u) do {
    uint view = findLSB(left);
    left &= left - 1u;
    if (survives(views[pair.first_view + view], candidate)) bits |= 1u << view;
  } while (left != 0u);
  return bits;
}

// One thread for each map and block. Where order is kept there is one view, and a pair for every block in its place.
void find_pairs() {
  uint thread = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * CULL_GROUP_SIZE;
  if (thread >= cull.block_count * cull.map_count) return;
  uint block = thread % cull.block_count;
  uint first_view = cull.first_map, view_count = 1u;
  if (keep_order == 0u) {
    uint map = cull.first_map + thread / cull.block_count;
    first_view = maps[map].first_view;
    view_count = maps[map].is_kept != 0u ? 0u : maps[map].view_count;
  }
  uint bits = 0u;
  uint i = 0u;
  BlockBox box = boxes[block];
  if (view_count > 0u) do {
    if (may_survive(views[first_view + i], box)) bits |= 1u << i;
  } while (++i < view_count);
  if (keep_order != 0u) {
    pairs[block] = BlockPair(block, first_view, bits, 0u, 0u);
    if (block == 0u) totals[0] = cull.block_count;
  } else if (bits != 0u) {
    pairs[atomicAdd(totals[0], 1u)] = BlockPair(block, first_view, bits, 0u, 0u);
  }
}

// The draws of a pair in one pass: view by view, within a view in the order of its batch instances. For all threads of a work
// group at once. Three counts in each word, of views 0 to 2 and 3 to 5; none exceeds CULL_GROUP_SIZE.
const uint COUNT_BITS = 10u;
shared uvec2 sums[2][CULL_GROUP_SIZE];

uvec2 packed_bits(uint bits) {
  uvec2 three = uvec2(bits, bits >> 3u);
  return (three & 1u) | (three >> 1u & 1u) << COUNT_BITS | (three >> 2u & 1u) << 2u * COUNT_BITS;
}

uint count_of(uvec2 counts, uint view) {
  uint word = view < 3u ? counts.x : counts.y;
  return word >> COUNT_BITS * (view % 3u) & (1u << COUNT_BITS) - 1u;
}

// For each view, the sum over all threads up to this one.
uvec2 sum_up_to_thread(uvec2 value) {
  uint thread = gl_LocalInvocationIndex;
  uint from = 0u;
  sums[0][thread] = value;
  barrier();
  uint step = 1u;
  do {
    uvec2 sum = sums[from][thread];
    if (thread >= step) sum += sums[from][thread - step];
    from = 1u - from;
    sums[from][thread] = sum;
    barrier();
    step *= 2u;
  } while (step < CULL_GROUP_SIZE);
  // Six steps: the whole sums lie in sums[0], of which nothing is written before the next barrier.
  return sums[from][thread];
}

// `place`: among the draws of the list.
void write_draw(uint list, uint place, uint view, BatchInstance drawn) {
  DrawSlots of_list = slots[list];
  uint first = cull.draw_pass * of_list.capacity;
  if (place < first || place - first >= of_list.capacity) return;
  uint slot = of_list.first + place - first;
  Batch batch = batches[drawn.batch];
  draws[slot] = CasterDraw(batch.index_count, 1u, batch.first_index, 0u, slot, view, drawn.instance, batch.material);
}

// `bits`: the views that this thread's batch instance is drawn in; `place`: of the pair's first draw among those of the list.
void append(uint list, uint place, uint first_view, BatchInstance candidate, uint bits) {
  uvec2 own = packed_bits(bits);
  uvec2 before = sum_up_to_thread(own) - own;
  uvec2 all = sums[0][CULL_GROUP_SIZE - 1u];
  barrier();
  uint view = 0u;
  do {
    if ((bits >> view & 1u) != 0u) write_draw(list, place + count_of(before, view), first_view + view, candidate);
    place += count_of(all, view);
  } while (++view < 6u);
}

// One thread per batch instance of a pair; a work group takes pairs in turns. Counts are added to the frame's counters.
// Where order is not kept, a pair's place among its list's draws is had on the way, and its draws of the first pass are written.
shared uint pair_draws, pair_triangles, pair_place;

void add_triangles(uint count) {
  uint before = atomicAdd(counters[cull.group].triangles, count);
  if (before + count < before) atomicAdd(counters[cull.group].triangles_high, 1u);
}

void finish_pair(uint number, uint list) {
  pairs[number].draw_count = pair_draws;
  if (pair_draws == 0u) return;
  if (keep_order == 0u) pairs[number].first_draw = pair_place = atomicAdd(totals[1u + list], pair_draws);
  atomicAdd(counters[cull.group].draws, pair_draws);
  add_triangles(pair_triangles);
}

void count_draws() {
  uint thread = gl_LocalInvocationIndex;
  uint number = gl_WorkGroupID.x, end = totals[0];
  if (number < end) do {
    if (thread == 0u) pair_draws = pair_triangles = 0u;
    barrier();
    BlockPair pair = pairs[number];
    BatchBlock block = blocks[pair.block];
    BatchInstance candidate = batch_instances[order[block.first + min(thread, block.count - 1u)]];
    uint bits = thread < block.count ? surviving_views(pair, candidate) : 0u;
    if (bits != 0u) {
      atomicAdd(pair_draws, bitCount(bits));
      atomicAdd(pair_triangles, bitCount(bits) * (batches[candidate.batch].index_count / 3u));
    }
    barrier();
    if (thread == 0u) finish_pair(number, block.list);
    barrier();
    if (keep_order == 0u && pair_draws != 0u) append(block.list, pair_place, pair.first_view, candidate, bits);
    barrier();
    number += gl_NumWorkGroups.x;
  } while (number < end);
}

// Does this pass draw any of the pair's draws?
bool is_in_pass(BlockPair pair, uint list) {
  uint capacity = slots[list].capacity, first = pair.first_draw - draws_before_list(list);
  return pair.draw_count != 0u && first / capacity <= cull.draw_pass && (first + pair.draw_count - 1u) / capacity >= cull.draw_pass;
}

void append_draws() {
  uint thread = gl_LocalInvocationIndex;
  uint number = gl_WorkGroupID.x, end = totals[0];
  if (number < end) do {
    BlockPair pair = pairs[number];
    BatchBlock block = blocks[pair.block];
    if (is_in_pass(pair, block.list)) {
      BatchInstance candidate = batch_instances[order[block.first + min(thread, block.count - 1u)]];
      uint bits = thread < block.count ? surviving_views(pair, candidate) : 0u;
      append(block.list, pair.first_draw - draws_before_list(block.list), pair.first_view, candidate, bits);
    }
    number += gl_NumWorkGroups.x;
  } while (number < end);
}

void main() {
  if (cull_step == FIND) find_pairs();
  else if (cull_step == COUNT) count_draws();
  else append_draws();
}
