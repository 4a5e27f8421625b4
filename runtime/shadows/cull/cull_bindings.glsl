// SPDX-License-Identifier: Apache-2.0
// What the dispatches of the cull stage read and write. In order:
//   block_boxes.comp            a box around each block of batch instances
//   cull_ANSWER.comp, FIND      which blocks may be seen from which maps
//   cull_ANSWER.comp, COUNT     how many of their batch instances are, in how many views; where order is not kept, the draws of
//                               the first pass
//   plan_draws.comp             where their draws go, and in which pass
//   cull_ANSWER.comp, APPEND    the draws of another pass
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"

layout(binding = 0, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 1, scalar) readonly buffer Maps { ShadowMap maps[]; };
layout(binding = 2, scalar) readonly buffer BatchInstances { BatchInstance batch_instances[]; };
layout(binding = 3, scalar) readonly buffer Batches { Batch batches[]; };
layout(binding = 4, scalar) readonly buffer Order { uint order[]; };  // batch instances, block by block
layout(binding = 5, scalar) readonly buffer Blocks { BatchBlock blocks[]; };
layout(binding = 6, scalar) buffer Boxes { BlockBox boxes[]; };
layout(binding = 7, scalar) readonly buffer Slots { DrawSlots slots[]; };  // one per draw list
layout(binding = 8, scalar) buffer Pairs { BlockPair pairs[]; };
layout(binding = 9, scalar) buffer Totals { uint totals[]; };  // pairs; draws of each list; draws before each list
layout(binding = 10, scalar) buffer Draws { CasterDraw draws[]; };
layout(binding = 11, scalar) buffer Counts { uint draw_counts[]; };  // of the lists of pass 0, of pass 1 ...
layout(binding = 12, scalar) buffer Appends { uint append_groups[]; };  // three for each pass: an indirect dispatch
layout(binding = 13, scalar) buffer Counters { CullCounters counters[]; };
layout(push_constant, scalar) uniform Push { CullConstants cull; };

uint draws_of_list(uint list) { return totals[1u + list]; }
uint draws_before_list(uint list) { return totals[1u + cull.list_count + list]; }
