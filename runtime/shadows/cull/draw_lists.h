// SPDX-License-Identifier: Apache-2.0
// What is culled together and drawn by one call: draw lists of batch instances, and blocks of them. Needs no device.
#pragma once

#include <cstdint>
#include <vector>

#include "frame_schema.h"
#include "pack_file.h"

namespace chandelier {

/// Where a draw's triangles come from: every list draws from one stream.
enum class GeometryStream : uint32_t { batches };

/// What one indirect multi-draw draws.
struct DrawList {
  GeometryStream stream = GeometryStream::batches;
  uint32_t material = pack::none;  // none: everything opaque
  uint32_t batch_instances = 0;    // each may be drawn once in a view
  uint32_t first_block = 0;
};

struct DrawLists {
  std::vector<DrawList> lists;
  std::vector<uint32_t> order;            // batch instances, list by list and block by block
  std::vector<frame::BatchBlock> blocks;  // list by list
};

/// For shading: one list per material, in the pack's order, which decides what is seen where surfaces coincide.
DrawLists lists_by_material(const pack::View& pack);
/// For shadows: what throws one. A list of everything opaque, and one for each masked material; batch instances that
/// are near each other share a block.
DrawLists lists_for_shadows(const pack::View& pack);

/// CasterDraws that are kept at a time, unless told otherwise: 64 MiB.
constexpr uint64_t most_caster_draws = uint64_t{1} << 21;
/// A group of maps has no more views than can fill this many passes, unless it is a single map.
constexpr uint64_t most_draw_passes = 64;

/// The views of a group of maps for which so many draws suffice in most_draw_passes.
uint64_t most_views(uint64_t batch_instances, uint64_t most_draws);

/// Divides room for `views` views of every batch instance, but no more than `most_draws` and not more than
/// `most_of_list` for one list, among the lists.
std::vector<frame::DrawSlots> divide_draws(const std::vector<DrawList>& lists, uint64_t views, uint64_t most_draws,
                                           uint64_t most_of_list);
/// Passes that `views` views take at most.
uint32_t passes_at_most(const std::vector<DrawList>& lists, const std::vector<frame::DrawSlots>& slots, uint64_t views);

}  // namespace chandelier
