// SPDX-License-Identifier: Apache-2.0
// The boxes of blocks, from those of their batch instances: one thread per block.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull_bindings.glsl"

layout(local_size_x = CULL_GROUP_SIZE) in;

void main() {
  uint number = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * CULL_GROUP_SIZE;
  if (number >= cull.block_count) return;
  BatchBlock block = blocks[number];
  BlockBox box = BlockBox(vec3(uintBitsToFloat(0x7F800000u)), vec3(uintBitsToFloat(0xFF800000u)));
  uint i = block.first, end = block.first + block.count;
  do {
    BatchInstance member = batch_instances[order[i]];
    box.min_ws = min(box.min_ws, member.bounds_min_ws);
    box.max_ws = max(box.max_ws, member.bounds_max_ws);
  } while (++i < end);
  boxes[number] = box;
}
