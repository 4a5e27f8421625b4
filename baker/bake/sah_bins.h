// SPDX-License-Identifier: Apache-2.0
// Sorts boxes into bins along each axis, to split groups of boxes by the surface area heuristic (SAH). Hierarchies and
// batches use it. It works on four floats at a time.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "bvh_item.h"

/// A namespace of its own, since its names are short.
namespace chandelier::baker::sah {

/// Four floats in one register, with GCC's and Clang's operators; the last one is unused.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

constexpr size_t most_bins = 32;
constexpr float infinite = std::numeric_limits<float>::infinity();

inline Float4 min(Float4 a, Float4 b) {
  return a < b ? a : b;
}
inline Float4 max(Float4 a, Float4 b) {
  return a > b ? a : b;
}

struct Box {
  Float4 low = {infinite, infinite, infinite, 0};
  Float4 high = {-infinite, -infinite, -infinite, 0};

  void add(Float4 other_low, Float4 other_high) {
    low = min(low, other_low);
    high = max(high, other_high);
  }
  void add(const Box& other) { add(other.low, other.high); }
  float half_area() const {
    const Float4 size = high - low, sides = size * __builtin_shufflevector(size, size, 1, 2, 0, 3);
    return sides[0] + sides[1] + sides[2];
  }
};

/// Loads two registers; the lane after the three components becomes zero.
inline Box box_of(const BvhItem& item) {
  static_assert(offsetof(BvhItem, low) == 0 && offsetof(BvhItem, high) == 16);
  const auto* bytes = reinterpret_cast<const std::byte*>(&item);
  const Int4 three = {-1, -1, -1, 0};
  Int4 low, high;
  std::memcpy(&low, bytes, 16);
  std::memcpy(&high, bytes + 16, 16);
  return {std::bit_cast<Float4>(low & three), std::bit_cast<Float4>(high & three)};
}

/// Twice the centre of a box, which is enough to compare positions.
inline Float4 centre(const Box& box) {
  return box.low + box.high;
}

/// Finds the bin of a centre on each axis.
struct Binning {
  Float4 low, scale;
  size_t bins;

  Binning(const Box& centres, size_t bin_count) : low(centres.low), bins(bin_count) {
    const Float4 size = centres.high - centres.low;
    for (int axis = 0; axis < 4; ++axis) {
      // Neither an axis without an extent nor one whose extent is beyond a float can be cut.
      const float per_metre = static_cast<float>(bins) / size[axis];
      scale[axis] = axis < 3 && std::isfinite(per_metre) ? per_metre : 0;
    }
  }
  bool can_cut(int axis) const { return scale[axis] > 0; }
  Int4 of(Float4 at) const {
    const float last = static_cast<float>(bins - 1);
    const Float4 most = {last, last, last, last}, least = {0, 0, 0, 0};
    return __builtin_convertvector(max(min((at - low) * scale, most), least), Int4);  // 0 or last for NaN
  }
};

/// It has no constructor, so that making many costs nothing; start from empty().
struct Bin {
  Float4 low, high;
  uint32_t items;

  static Bin empty() { return {Box().low, Box().high, 0}; }
  float cost() const { return Box{low, high}.half_area() * static_cast<float>(items); }
  void add(const Box& box, uint32_t count) {
    low = min(low, box.low);
    high = max(high, box.high);
    items += count;
  }
  void add(const Bin& other) { add({other.low, other.high}, other.items); }
};

using AxisBins = std::array<Bin, most_bins>;

inline std::array<AxisBins, 3> fill_bins(std::span<const BvhItem> items, const Binning& binning, size_t stride) {
  std::array<AxisBins, 3> axes;
  for (AxisBins& bins : axes) std::fill_n(bins.begin(), binning.bins, Bin::empty());
  for (size_t i = 0; i < items.size(); i += stride) {
    const Box box = box_of(items[i]);
    const Int4 at = binning.of(centre(box));
    for (size_t axis = 0; axis < 3; ++axis) axes[axis][static_cast<size_t>(at[axis])].add(box, 1);
  }
  return axes;
}

/// Moves the items of the bins below `bin` to the front and returns their number; `left` and `right` become the bounds
/// of both sides' centres. The side of an item is hard to predict, so nothing here branches on it.
inline size_t partition(std::span<BvhItem> items, const Binning& binning, int axis, size_t bin, Box& left, Box& right) {
  const Box nothing;
  const float low = binning.low[axis], scale = binning.scale[axis], border = static_cast<float>(bin);
  size_t count = 0;
  for (BvhItem& item : items) {
    const Float4 at = centre(box_of(item));
    const bool is_left = (item.low[axis] + item.high[axis] - low) * scale < border;
    const Int4 left_mask = Int4{} - static_cast<int32_t>(is_left);
    left.add(left_mask ? at : nothing.low, left_mask ? at : nothing.high);
    right.add(left_mask ? nothing.low : at, left_mask ? nothing.high : at);
    const BvhItem this_one = item;
    item = items[count];
    items[count] = this_one;
    count += is_left;
  }
  return count;
}

inline Box centres_of(std::span<const BvhItem> items) {
  // Least and greatest values: the same in any order.
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, items.size(), 16384), Box(),
      [&](const auto& range, Box box) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const Float4 at = centre(box_of(items[i]));
          box.add(at, at);
        }
        return box;
      },
      [](Box a, const Box& b) {
        a.add(b);
        return a;
      });
}

}  // namespace chandelier::baker::sah
