// SPDX-License-Identifier: Apache-2.0
// Binned SAH (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"): the items' centres fall into
// equal bins along each axis, and a node is cut at the bin border where area times items, summed over both sides, is
// least.
#include "bvh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "sah_bins.h"

namespace chandelier::baker {
namespace {

using namespace sah;

constexpr float traversal_cost = 1;       // of a node, where an item costs 1
constexpr size_t most_tried = 5;          // items; up to this many, all partitions are tried
constexpr size_t block_nodes = 16384;     // nodes that one task writes
constexpr size_t parallel_items = 16384;  // items; the two sides of larger nodes are built by two threads
constexpr size_t samples = 2048;          // items sampled to choose the cut of a node with at least twice as many
constexpr size_t treelet_items = 32;      // largest number of items in a treelet
constexpr int sah_depth = 64;             // deeper nodes are cut into halves, so that no input makes a degenerate tree

struct Cut {
  int axis = -1;          // none
  size_t bin = 0;         // the first of the second child
  float cost = infinite;  // area times items, of both children
};

void find_cut(const AxisBins& bins, size_t count, int axis, Cut& best) {
  std::array<float, most_bins> right_costs;
  Bin right = Bin::empty();
  for (size_t i = count - 1; i > 0; --i) {
    right.add(bins[i]);
    right_costs[i] = right.items == 0 ? infinite : right.cost();
  }
  Bin left = Bin::empty();
  for (size_t i = 1; i < count; ++i) {
    left.add(bins[i - 1]);
    if (left.items == 0) continue;
    const float cost = left.cost() + right_costs[i];
    if (cost < best.cost) best = {axis, i, cost};  // false for NaN
  }
}

Cut find_cut(std::span<const BvhItem> items, const Binning& binning, size_t stride) {
  Cut best;
  if (!binning.can_cut(0) && !binning.can_cut(1) && !binning.can_cut(2)) return best;
  const std::array<AxisBins, 3> axes = fill_bins(items, binning, stride);
  for (int axis = 0; axis < 3; ++axis) {
    if (binning.can_cut(axis)) find_cut(axes[static_cast<size_t>(axis)], binning.bins, axis, best);
  }
  return best;
}

/// Moves the items of the first child to the front and returns their number; 0 for a leaf of up to `most_leaf` items.
size_t cut(std::span<BvhItem> items, size_t most_leaf, const Box& centres, int depth, Box& left, Box& right) {
  const Binning binning(centres, std::min(most_bins, 4 + items.size() / 16));
  Cut best;
  if (depth < sah_depth) {
    best = find_cut(items, binning, std::max<size_t>(1, items.size() / samples));
    if (best.axis < 0 && items.size() >= 2 * samples) best = find_cut(items, binning, 1);
  }
  const size_t count = best.axis < 0 ? 0 : partition(items, binning, best.axis, best.bin, left, right);
  if (count > 0 && count < items.size()) return count;
  // No plane separates the centres, or areas overflow a float.
  if (items.size() <= most_leaf) return 0;
  left = right = centres;
  return items.size() / 2;
}

/// The best of all partitions of up to most_tried items into two children, or one leaf.
void add_few(std::span<BvhItem> items, size_t most_leaf, BvhShape& shape) {
  const unsigned all = (1u << items.size()) - 1;
  std::array<Bin, 1u << most_tried> sets;  // by the bits of their items
  sets[0] = Bin::empty();
  for (unsigned set = 1; set <= all; ++set) {
    sets[set] = sets[set & (set - 1)];
    sets[set].add(box_of(items[static_cast<size_t>(std::countr_zero(set))]), 1);
  }
  const float area = Box{sets[all].low, sets[all].high}.half_area();
  const bool can_be_leaf = items.size() <= most_leaf;
  float best_cost = can_be_leaf ? sets[all].cost() : infinite;
  unsigned best = can_be_leaf ? 0 : 1;  // the first child's items; the second child has the last item
  for (unsigned set = 1; set <= all / 2; ++set) {
    const float cost = traversal_cost * area + sets[set].cost() + sets[all - set].cost();
    if (cost < best_cost) {
      best_cost = cost;
      best = set;
    }
  }
  shape.push_back(static_cast<uint8_t>(best == 0 ? items.size() : 0));
  if (best == 0) return;
  std::array<BvhItem, most_tried> sorted;
  size_t left = 0, right = static_cast<size_t>(std::popcount(best));
  for (size_t i = 0; i < items.size(); ++i) sorted[best >> i & 1 ? left++ : right++] = items[i];
  std::copy_n(sorted.begin(), items.size(), items.begin());
  add_few(items.first(left), most_leaf, shape);
  add_few(items.subspan(left), most_leaf, shape);
}

void add(std::span<BvhItem> items, size_t most_leaf, const Box& centres, int depth, BvhShape& shape) {
  if (items.size() <= most_tried) return add_few(items, most_leaf, shape);
  Box left_centres, right_centres;
  const size_t left = cut(items, most_leaf, centres, depth, left_centres, right_centres);
  shape.push_back(static_cast<uint8_t>(left == 0 ? items.size() : 0));
  if (left == 0) return;
  if (items.size() < parallel_items) {
    add(items.first(left), most_leaf, left_centres, depth + 1, shape);
    add(items.subspan(left), most_leaf, right_centres, depth + 1, shape);
    return;
  }
  BvhShape right_shape;
  tbb::task_group group;
  group.run([&] { add(items.subspan(left), most_leaf, right_centres, depth + 1, right_shape); });
  add(items.first(left), most_leaf, left_centres, depth + 1, shape);
  group.wait();
  shape.insert(shape.end(), right_shape.begin(), right_shape.end());
}

/// `first_item` is the number of items[0].
void add_treelets(std::span<BvhItem> items, uint32_t first_item, const Box& centres, int depth, Treelets& out) {
  if (items.size() > treelet_items) {
    Box left_centres, right_centres;
    const size_t left = cut(items, most_leaf_items, centres, depth, left_centres, right_centres);
    add_treelets(items.first(left), first_item, left_centres, depth + 1, out);
    add_treelets(items.subspan(left), first_item + static_cast<uint32_t>(left), right_centres, depth + 1, out);
    return;
  }
  BvhItem box = {items[0].low, first_item, items[0].high, 0};
  for (const BvhItem& item : items) {
    box.low = glm::min(box.low, item.low);
    box.high = glm::max(box.high, item.high);
  }
  out.boxes.push_back(box);
  out.item_counts.push_back(static_cast<uint32_t>(items.size()));
  const size_t nodes = out.shape.size();
  add(items, most_leaf_items, centres, depth, out.shape);
  out.node_counts.push_back(static_cast<uint32_t>(out.shape.size() - nodes));
}

/// The source and the destination of a treelet.
struct TreeletMove {
  uint32_t from_item, items;
  const uint8_t* from_shape;
  uint32_t nodes, to_item = 0, to_node = 0;
};

std::vector<TreeletMove> list(std::span<const Treelets> parts, std::vector<BvhItem>& boxes) {
  std::vector<TreeletMove> moves;
  for (const Treelets& part : parts) {
    const uint8_t* shape = part.shape.data();
    for (size_t i = 0; i < part.boxes.size(); ++i) {
      moves.push_back({part.boxes[i].number, part.item_counts[i], shape, part.node_counts[i]});
      shape += part.node_counts[i];
      boxes.push_back(part.boxes[i]);
      boxes.back().number = static_cast<uint32_t>(moves.size() - 1);
    }
  }
  return moves;
}

/// Writes the nodes of one tree. Blocks are written in parallel, each of them backwards, so that children come before
/// their parents.
struct Filler {
  std::span<const BvhItem> items;
  std::span<const uint32_t> order;  // of the items in the leaves; empty if the items are sorted
  const BvhShape& shape;
  BvhPlace place;
  std::span<pack::BvhNode> nodes;
  std::span<pack::NodeArea> areas;

  /// `item`: the first of the leaf, counted within the tree.
  void fill_leaf(uint32_t number, uint32_t item, uint32_t count) const {
    // A treelet's items, and so a leaf's, are side by side in either order.
    const std::span<const BvhItem> own = items.subspan(order.empty() ? item : order[item], count);
    pack::BvhNode node = {own[0].low, number + 1, own[0].high, (place.first_item + item) * 16 + count};
    float area_m2 = own[0].area_m2;
    for (const BvhItem& other : own.subspan(1)) {
      node.bounds_min = glm::min(node.bounds_min, other.low);
      node.bounds_max = glm::max(node.bounds_max, other.high);
      area_m2 = add_areas(area_m2, other.area_m2);
    }
    nodes[number] = node;
    if (!areas.empty()) areas[number].area_m2 = area_m2;
  }

  /// Does nothing and returns false if a child is not below `end` or not written yet. The skip of a written node is
  /// above 0.
  bool fill_inner(uint32_t number, uint32_t end) const {
    if (number + 1 >= end) return false;
    const pack::BvhNode& left = nodes[number + 1];
    if (left.skip == 0 || left.skip >= end) return false;
    const pack::BvhNode& right = nodes[left.skip];
    if (right.skip == 0) return false;
    nodes[number] = {glm::min(left.bounds_min, right.bounds_min), right.skip,
                     glm::max(left.bounds_max, right.bounds_max), pack::none};
    if (!areas.empty()) areas[number].area_m2 = add_areas(areas[number + 1].area_m2, areas[left.skip].area_m2);
    return true;
  }

  /// Writes the nodes from `first` to `end` of the tree; their items end at `item`. Returns the nodes that have a child
  /// outside of that range.
  std::vector<uint32_t> fill_block(size_t first, size_t end, uint32_t item) const {
    std::vector<uint32_t> left_open;
    const auto number_of = [&](size_t i) { return place.first_node + static_cast<uint32_t>(i); };
    for (size_t i = end; i-- > first;) {
      if (shape[i] != 0) {
        item -= shape[i];
        fill_leaf(number_of(i), item, shape[i]);
      } else if (!fill_inner(number_of(i), number_of(end))) {
        left_open.push_back(number_of(i));
      }
    }
    return left_open;
  }

  /// Sums that overflow a float become the largest float.
  static float add_areas(float a, float b) { return std::min(a + b, std::numeric_limits<float>::max()); }
};

/// Rounds to 11 significant bits, which compress well. Areas are estimates for points; the relative error is at most
/// 2^-11.
float rounded(float area_m2) {
  constexpr uint32_t dropped = (1u << 13) - 1;
  const auto bits = std::bit_cast<uint32_t>(area_m2) + dropped / 2 + 1;
  return std::min(std::bit_cast<float>(bits & ~dropped), std::numeric_limits<float>::max());
}

double half_area(const pack::BvhNode& node) {
  const glm::dvec3 size = glm::dvec3(node.bounds_max) - glm::dvec3(node.bounds_min);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace

BvhShape shape_bvh(std::span<BvhItem> items, size_t most_leaf) {
  BvhShape shape;
  if (!items.empty()) add(items, most_leaf, centres_of(items), 0, shape);
  return shape;
}

void shape_treelets(std::span<BvhItem> items, uint32_t first_item, Treelets& out) {
  if (!items.empty()) add_treelets(items, first_item, centres_of(items), 0, out);
}

BvhShape join_treelets(std::span<const Treelets> parts, std::vector<uint32_t>& order) {
  std::vector<BvhItem> boxes;
  std::vector<TreeletMove> moves = list(parts, boxes);
  const BvhShape top = shape_bvh(boxes, 1);
  BvhShape shape;
  uint32_t node = 0, item = 0, leaf = 0;
  for (const TreeletMove& move : moves) node += move.nodes, item += move.items;
  shape.resize(node + top.size() - moves.size());
  order.resize(item);
  node = item = 0;
  for (const uint8_t of_top : top) {
    if (of_top == 0) {
      ++node;  // an inner node
      continue;
    }
    TreeletMove& move = moves[boxes[leaf++].number];
    move.to_node = node;
    move.to_item = item;
    node += move.nodes;
    item += move.items;
  }
  tbb::parallel_for(tbb::blocked_range<size_t>(0, moves.size(), 1024), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const TreeletMove& move = moves[i];
      std::copy_n(move.from_shape, move.nodes, shape.begin() + move.to_node);
      std::iota(order.begin() + move.to_item, order.begin() + move.to_item + move.items, move.from_item);
    }
  });
  return shape;
}

void fill_bvh(std::span<const BvhItem> items, std::span<const uint32_t> order, const BvhShape& shape,
              const BvhPlace& place, std::span<pack::BvhNode> nodes, std::span<pack::NodeArea> areas) {
  const Filler filler{items, order, shape, place, nodes, areas};
  const size_t blocks = (shape.size() + block_nodes - 1) / block_nodes;
  const auto block_end = [&](size_t block) { return std::min((block + 1) * block_nodes, shape.size()); };
  std::vector<uint32_t> last_items(blocks);
  uint32_t item = 0;
  for (size_t b = 0; b < blocks; ++b) {
    for (size_t i = b * block_nodes; i < block_end(b); ++i) item += shape[i];
    last_items[b] = item;
  }
  std::vector<std::vector<uint32_t>> left_open(blocks);
  tbb::parallel_for(size_t{0}, blocks,
                    [&](size_t b) { left_open[b] = filler.fill_block(b * block_nodes, block_end(b), last_items[b]); });
  for (size_t b = blocks; b-- > 0;) {
    for (const uint32_t number : left_open[b]) filler.fill_inner(number, pack::none);
  }
  if (areas.empty()) return;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, shape.size(), block_nodes), [&](const auto& range) {
    for (pack::NodeArea& area : areas.subspan(place.first_node + range.begin(), range.size())) {
      area.area_m2 = rounded(area.area_m2);  // after summing, so that errors do not add up
    }
  });
}

BvhStats bvh_stats(std::span<const pack::BvhNode> nodes, uint32_t first_node) {
  BvhStats stats;
  stats.nodes = nodes.size();
  double cost = 0;
  std::vector<uint32_t> ends;  // of the subtrees that a node is in
  for (size_t i = 0; i < nodes.size(); ++i) {
    while (!ends.empty() && ends.back() <= first_node + i) ends.pop_back();
    ends.push_back(nodes[i].skip);
    stats.depth = std::max<uint64_t>(stats.depth, ends.size());
    const bool is_leaf = nodes[i].leaf != pack::none;
    stats.leaves += is_leaf;
    cost += half_area(nodes[i]) * (is_leaf ? 1 + nodes[i].leaf % 16 : 1);
  }
  if (!nodes.empty() && half_area(nodes[0]) > 0) stats.sah_cost = cost / half_area(nodes[0]);
  return stats;
}

void count_stats(const BvhStats& stats, PassReport& pass) {
  pass.count("nodes", static_cast<double>(stats.nodes));
  pass.count("leaves", static_cast<double>(stats.leaves));
  pass.count("depth", static_cast<double>(stats.depth));
  pass.count("sah_cost", stats.sah_cost);
}

}  // namespace chandelier::baker
