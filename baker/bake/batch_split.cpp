// SPDX-License-Identifier: Apache-2.0
// Binned SAH with a price for batches that are not full: a group of n triangles is expected to become ⌈n / most⌉
// batches, and each costs as much as some triangles. So splits fall where the left side is a whole number of batches,
// unless a gap elsewhere is worth more. Large groups are cut by a sample, where a batch more or less does not matter.
#include "batch_split.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "sah_bins.h"

namespace chandelier::baker {
namespace {

using namespace sah;

using Boxes = std::span<BvhItem>;

constexpr size_t parallel_split = 8192;  // triangles; the two sides of larger groups are split by two threads
constexpr size_t samples = 4096;         // triangles sampled from a group of at least twice as many
constexpr double batch_cost = 0.5;       // of testing and drawing a batch, relative to the triangles of a full batch
constexpr float batch_begin = 1;         // value of area_m2 that marks the first triangle of a batch

/// `left` triangles go left: those of the bins below `bin`, and if that is not enough, the lowest centres of `bin`.
struct Split {
  int axis = -1;
  size_t bin = 0, left = 0;
  double cost = INFINITY;
};

/// The expected cost of a group of triangles, per unit of area.
double weight(size_t triangles, size_t most) {
  const size_t batches = (triangles + most - 1) / most;
  return static_cast<double>(triangles) + batch_cost * static_cast<double>(batches * most);
}

/// The best split along an axis: between two bins, or inside one where the left side is a whole number of batches;
/// there both sides are charged for the whole bin. Of samples, each in a batch of its own, only between bins.
void find_split(const AxisBins& bins, size_t bin_count, int axis, size_t total, size_t most, Split& best) {
  std::array<double, most_bins> area_from;
  Box right;
  for (size_t i = bin_count; i-- > 0;) {
    right.add(bins[i].low, bins[i].high);
    area_from[i] = double{right.half_area()};
  }
  const auto offer = [&](size_t bin, size_t count, double left_area) {
    const double cost = left_area * weight(count, most) + area_from[bin] * weight(total - count, most);
    if (cost < best.cost) best = {axis, bin, count, cost};  // false for NaN
  };
  Box left;
  size_t below = 0;
  double left_area = 0;
  for (size_t i = 0; i < bin_count; ++i) {
    if (below > 0 && below < total) offer(i, below, left_area);
    if (bins[i].items == 0) continue;
    left.add(bins[i].low, bins[i].high);
    left_area = double{left.half_area()};
    const size_t whole = (below / most + 1) * most;
    below += bins[i].items;
    if (most > 1 && whole < below && whole < total) offer(i, whole, left_area);
  }
}

Split find_split(Boxes boxes, const Binning& binning, size_t stride, size_t most) {
  const std::array<AxisBins, 3> axes = fill_bins(boxes, binning, stride);
  const size_t total = (boxes.size() + stride - 1) / stride;
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!binning.can_cut(axis)) continue;
    find_split(axes[static_cast<size_t>(axis)], binning.bins, axis, total, stride > 1 ? 1 : most, best);
  }
  return best;
}

/// Two groups, and the bounds of the centres of each.
struct Halves {
  size_t left = 0;
  Box left_centres, right_centres;
};

/// Moves the triangles of the left side to the front.
Halves part(Boxes boxes, const Binning& binning, const Split& split, bool sampled) {
  Halves out;
  out.left = partition(boxes, binning, split.axis, split.bin, out.left_centres, out.right_centres);
  if (sampled || out.left == split.left) return out;
  Box below, above;
  const Boxes rest = boxes.subspan(out.left);
  const Boxes in_bin = rest.first(partition(rest, binning, split.axis, split.bin + 1, below, above));
  const auto centre_of = [&](const BvhItem& box) { return box.low[split.axis] + box.high[split.axis]; };
  std::nth_element(in_bin.begin(), in_bin.begin() + static_cast<ptrdiff_t>(split.left - out.left), in_bin.end(),
                   [&](const BvhItem& a, const BvhItem& b) {
                     const float left = centre_of(a), right = centre_of(b);
                     return left != right ? left < right : a.number < b.number;
                   });
  return {split.left, centres_of(boxes.first(split.left)), centres_of(boxes.subspan(split.left))};
}

Halves halve(Boxes boxes, const Box& centres, size_t most) {
  const Binning binning(centres, most_bins);
  if (const size_t stride = boxes.size() / samples; stride > 1) {
    const Split split = find_split(boxes, binning, stride, most);
    if (split.axis >= 0) return part(boxes, binning, split, true);
  }
  const Split split = find_split(boxes, binning, 1, most);
  if (split.axis >= 0) return part(boxes, binning, split, false);
  // All centres coincide, or areas overflow a float: splits into halves of whole batches, in the given order.
  return {((boxes.size() + most - 1) / most + 1) / 2 * most, centres, centres};
}

void divide(Boxes boxes, const Box& centres, size_t most) {
  if (boxes.size() <= most) {
    boxes[0].area_m2 = batch_begin;
    return;
  }
  const Halves halves = halve(boxes, centres, most);
  const Boxes left = boxes.first(halves.left), right = boxes.subspan(halves.left);
  if (boxes.size() < parallel_split) {
    divide(left, halves.left_centres, most);
    divide(right, halves.right_centres, most);
  } else {
    tbb::parallel_invoke([&] { divide(left, halves.left_centres, most); },
                         [&] { divide(right, halves.right_centres, most); });
  }
}

}  // namespace

BvhItem triangle_box(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint32_t triangle) {
  return {glm::min(glm::min(a, b), c), triangle, glm::max(glm::max(a, b), c), 0};
}

BatchOrder split_into_batches(std::vector<BvhItem>&& boxes, size_t most) {
  BatchOrder out;
  if (boxes.empty()) return out;
  divide(boxes, centres_of(boxes), most);
  out.triangles.reserve(boxes.size());
  for (const BvhItem& box : boxes) {
    if (box.area_m2 == batch_begin) out.counts.push_back(0);
    ++out.counts.back();
    out.triangles.push_back(box.number);
  }
  boxes = {};
  return out;
}

}  // namespace chandelier::baker
