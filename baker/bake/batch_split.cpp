// SPDX-License-Identifier: Apache-2.0
// Binned SAH (Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies) with a price for batches that
// are not full: a group of n triangles is expected to become ⌈n / most⌉ batches, and each costs as much as some
// triangles. So splits fall where the left side is a whole number of batches, unless a gap elsewhere is worth more.
#include "batch_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace chandelier::baker {
namespace {

using Boxes = std::span<TriangleBox>;

constexpr int kMostBins = 32;
constexpr std::size_t kParallelSplit = 8192, kParallelBins = 65536;
constexpr double kBatchCost = 0.5;  // of testing and drawing a batch, in full batches' triangles

float center(const TriangleBox& box, int axis) {
  return 0.5f * box.low[axis] + 0.5f * box.high[axis];
}

std::uint32_t number_of(const TriangleBox& box) {
  return std::bit_cast<std::uint32_t>(box.low[3]);
}

struct Box {
  float low[4] = {INFINITY, INFINITY, INFINITY, 0}, high[4] = {-INFINITY, -INFINITY, -INFINITY, 0};

  void include(const float* other_low, const float* other_high) {
    for (int i = 0; i < 4; ++i) low[i] = other_low[i] < low[i] ? other_low[i] : low[i];
    for (int i = 0; i < 4; ++i) high[i] = other_high[i] > high[i] ? other_high[i] : high[i];
  }

  double half_area() const {
    const double x = double{high[0]} - low[0], y = double{high[1]} - low[1], z = double{high[2]} - low[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
  }
};

/// Where the triangles' centres are cut into bins, along each axis.
struct BinRule {
  float low[3], per_size[3];  // both 0 where all centres are the same, or too far apart for a float
  int bins;

  int bin_of(const TriangleBox& box, int axis) const {
    return std::min(static_cast<int>((center(box, axis) - low[axis]) * per_size[axis]), bins - 1);
  }
};

BinRule bin_rule(Boxes boxes) {
  const auto bounds_of = [](const Boxes part, Box sum) {
    for (const TriangleBox& box : part) {
      const float at[4] = {center(box, 0), center(box, 1), center(box, 2), 0};
      sum.include(at, at);
    }
    return sum;
  };
  Box centers;
  if (boxes.size() < kParallelBins) {
    centers = bounds_of(boxes, {});
  } else {
    centers = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, boxes.size(), 16384), Box(),
        [&](const auto& range, const Box& sum) { return bounds_of(boxes.subspan(range.begin(), range.size()), sum); },
        [](Box a, const Box& b) { return a.include(b.low, b.high), a; });
  }
  BinRule rule{};
  rule.bins = boxes.size() > 2048 ? 16 : kMostBins;
  for (int axis = 0; axis < 3; ++axis) {
    const float size = centers.high[axis] - centers.low[axis];
    const float per_size = static_cast<float>(rule.bins) / size;
    if (!std::isfinite(size) || !std::isfinite(per_size)) continue;
    rule.low[axis] = centers.low[axis];
    rule.per_size[axis] = per_size;
  }
  return rule;
}

struct Bins {
  Box box[3][kMostBins];
  std::uint32_t count[3][kMostBins] = {};

  void include(const Boxes boxes, const BinRule& rule) {
    for (const TriangleBox& triangle : boxes) {
      for (int axis = 0; axis < 3; ++axis) {
        const int bin = rule.bin_of(triangle, axis);
        box[axis][bin].include(triangle.low, triangle.high);
        ++count[axis][bin];
      }
    }
  }

  void include(const Bins& other) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kMostBins; ++i) {
        box[axis][i].include(other.box[axis][i].low, other.box[axis][i].high);
        count[axis][i] += other.count[axis][i];
      }
    }
  }
};

Bins fill_bins(Boxes boxes, const BinRule& rule) {
  Bins bins;
  if (boxes.size() < kParallelBins) {
    bins.include(boxes, rule);
    return bins;
  }
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, boxes.size(), 16384), bins,
      [&](const auto& range, Bins sum) {
        sum.include(boxes.subspan(range.begin(), range.size()), rule);
        return sum;
      },
      [](Bins a, const Bins& b) { return a.include(b), a; });
}

/// `left` triangles go left: those of the bins below `bin`, and if that is not enough, the lowest centres of `bin`.
struct Split {
  int axis = -1, bin = 0;
  std::size_t left = 0;
  double cost = INFINITY;
};

/// Of a group of triangles, per area.
double weight(std::size_t triangles, std::size_t most) {
  const std::size_t batches = (triangles + most - 1) / most;
  return static_cast<double>(triangles) + kBatchCost * static_cast<double>(batches * most);
}

/// The best split along an axis: between two bins, or inside one where the left side is a whole number of batches;
/// there both sides are charged for the whole bin.
void find_split(const Bins& bins, int bin_count, int axis, std::size_t total, std::size_t most, Split& best) {
  double area_from[kMostBins + 1] = {};
  Box right;
  for (int i = bin_count; i-- > 0;) {
    right.include(bins.box[axis][i].low, bins.box[axis][i].high);
    area_from[i] = right.half_area();
  }
  const auto offer = [&](int bin, std::size_t count, double left_area, double right_area) {
    const double cost = left_area * weight(count, most) + right_area * weight(total - count, most);
    if (cost < best.cost) best = {axis, bin, count, cost};
  };
  Box left;
  std::size_t below = 0;
  for (int i = 0; i < bin_count; ++i) {
    const double left_area = left.half_area();
    if (below > 0 && below < total) offer(i, below, left_area, area_from[i]);
    left.include(bins.box[axis][i].low, bins.box[axis][i].high);
    const std::size_t whole = (below / most + 1) * most;
    below += bins.count[axis][i];
    if (whole < below && whole < total) offer(i, whole, left.half_area(), area_from[i]);
  }
}

/// Puts the left side first.
void partition(Boxes boxes, const BinRule& rule, const Split& split) {
  const auto middle = std::partition(boxes.begin(), boxes.end(),
                                     [&](const TriangleBox& box) { return rule.bin_of(box, split.axis) < split.bin; });
  const auto below = static_cast<std::size_t>(middle - boxes.begin());
  if (below == split.left) return;
  const auto end = std::partition(middle, boxes.end(),
                                  [&](const TriangleBox& box) { return rule.bin_of(box, split.axis) == split.bin; });
  std::nth_element(middle, boxes.begin() + static_cast<std::ptrdiff_t>(split.left), end,
                   [&](const TriangleBox& a, const TriangleBox& b) {
                     const float left = center(a, split.axis), right = center(b, split.axis);
                     return left != right ? left < right : number_of(a) < number_of(b);
                   });
}

void divide(Boxes boxes, std::size_t most) {
  if (boxes.size() <= most) {
    boxes[0].high[3] = std::bit_cast<float>(1u);
    return;
  }
  const BinRule rule = bin_rule(boxes);
  Split split;
  {
    const Bins bins = fill_bins(boxes, rule);
    for (int axis = 0; axis < 3; ++axis) {
      if (rule.per_size[axis] > 0) find_split(bins, rule.bins, axis, boxes.size(), most, split);
    }
  }
  if (split.axis < 0) {  // all centres in one place: halves of whole batches, as they come
    split.left = ((boxes.size() + most - 1) / most + 1) / 2 * most;
  } else {
    partition(boxes, rule, split);
  }
  const Boxes left = boxes.first(split.left), right = boxes.subspan(split.left);
  if (boxes.size() < kParallelSplit) {
    divide(left, most);
    divide(right, most);
  } else {
    tbb::parallel_invoke([&] { divide(left, most); }, [&] { divide(right, most); });
  }
}

}  // namespace

TriangleBox triangle_box(const float* a, const float* b, const float* c, std::uint32_t triangle) {
  TriangleBox box;
  for (int i = 0; i < 3; ++i) {
    box.low[i] = std::min({a[i], b[i], c[i]});
    box.high[i] = std::max({a[i], b[i], c[i]});
  }
  box.low[3] = std::bit_cast<float>(triangle);
  return box;
}

BatchOrder split_into_batches(std::vector<TriangleBox>&& boxes, std::size_t most) {
  BatchOrder out;
  if (boxes.empty()) return out;
  divide(boxes, most);
  out.triangles.reserve(boxes.size());
  for (const TriangleBox& box : boxes) {
    if (std::bit_cast<std::uint32_t>(box.high[3]) == 1) out.counts.push_back(0);
    ++out.counts.back();
    out.triangles.push_back(number_of(box));
  }
  boxes = {};
  return out;
}

}  // namespace chandelier::baker
