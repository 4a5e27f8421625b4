// SPDX-License-Identifier: Apache-2.0
// What every culling answer shares: one thread per view and batch instance; who survives becomes a CasterDraw.
// The including shader defines `bool survives(ShadowView view, BatchInstance candidate)`.
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"

layout(local_size_x = CULL_GROUP_SIZE) in;
layout(binding = 0, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 1, scalar) readonly buffer BatchInstances { BatchInstance batch_instances[]; };
layout(binding = 2, scalar) readonly buffer Batches { Batch batches[]; };
layout(binding = 3, scalar) readonly buffer MaterialRuns { uint first_of_run[]; };
layout(binding = 4, scalar) readonly buffer RunOfBatchInstance { uint run_of_batch_instance[]; };  // with SHADOWLESS_BIT
layout(binding = 5, scalar) writeonly buffer Draws { CasterDraw draws[]; };
layout(binding = 6, scalar) buffer Counts { uint draw_counts[]; };  // one per draw list
layout(binding = 7, scalar) buffer Counters { CullCounters counters[]; };
layout(push_constant, scalar) uniform Push { CullConstants cull; };

bool survives(ShadowView view, BatchInstance candidate);

// List l holds the draws of its batch instances in every view, from first_of_run * view_count on. Where surfaces coincide,
// the first one drawn is seen: draws that make a picture keep their order, draws that make only depth need none.
void main() {
  uint thread = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * CULL_GROUP_SIZE;
  if (thread >= cull.batch_instance_count * cull.view_count) return;
  uint view = cull.first_view + thread / cull.batch_instance_count;
  uint number = thread % cull.batch_instance_count;
  BatchInstance candidate = batch_instances[number];
  bool visible = survives(views[view], candidate);
  if (!visible && cull.keep_order == 0u) return;

  uint run = run_of_batch_instance[number];
  if ((run & SHADOWLESS_BIT * cull.casters_only) != 0u) return;  // shadows' draws have no order that it could break
  run &= ~SHADOWLESS_BIT;
  bool merged = run < cull.merged_runs;
  uint list = merged ? 0u : run + 1u - cull.merged_runs;
  uint first = merged ? 0u : first_of_run[run];
  Batch batch = batches[candidate.batch];
  uint slot = cull.keep_order != 0u ? number : first * cull.view_count + atomicAdd(draw_counts[list], 1u);
  draws[slot] = CasterDraw(batch.index_count, uint(visible), batch.first_index, 0u, slot, view, candidate.instance,
                           batch.material);
  if (!visible) return;
  atomicAdd(counters[cull.round].draws, 1u);
  atomicAdd(counters[cull.round].triangles, batch.index_count / 3u);
}
