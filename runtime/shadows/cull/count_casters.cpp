// SPDX-License-Identifier: Apache-2.0
#include "shadows/cull/count_casters.h"

#include "stages/cull.h"
#include "throws_shadow.h"

namespace chandelier {
namespace {

template <typename Answer>
CasterCounts count(std::span<const frame::ShadowView> views, const World& world) {
  const pack::View& pack = world.pack();
  CasterCounts counts;
  for (const frame::ShadowView& view : views) {
    const Answer answer(view);
    for (const pack::BatchInstance& candidate : world.batch_instances()) {
      if (!pack::throws_shadow(pack, candidate) || !answer.survives(candidate)) continue;
      ++counts.draws;
      counts.triangles += pack.batches[candidate.batch].index_count / 3;
    }
  }
  return counts;
}

}  // namespace

CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, const World& world) {
  return with_cull(cull, [&]<typename Answer>() { return count<Answer>(views, world); });
}

}  // namespace chandelier
