// SPDX-License-Identifier: Apache-2.0
// Binary bounding volume hierarchies by the surface area heuristic (SAH), for batches, instances and triangles.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "../report.h"
#include "bvh_item.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// The shape of a tree, one byte per node in depth-first order: a leaf's number of items, or 0 for an inner node.
using BvhShape = std::vector<uint8_t>;

/// Largest number of items of all trees in a section: BvhNode::leaf has 28 bits for an item's number.
constexpr uint64_t most_bvh_items = (1u << 28) - 1;

/// Largest number of items in a leaf: BvhNode::leaf has 4 bits for it.
constexpr size_t most_leaf_items = 15;

/// Sorts `items` into the order of the leaves and returns the shape of the tree over them, empty if there are no items.
/// Uses all threads if there are many items; the result does not depend on the number of threads.
BvhShape shape_bvh(std::span<BvhItem> items, size_t most_leaf = most_leaf_items);

/// Treelets: the lower parts of a tree, each over up to 32 neighbouring items.
struct Treelets {
  std::vector<BvhItem> boxes;         // one per treelet; `number` is that of its first item
  std::vector<uint32_t> item_counts;  // of each
  std::vector<uint32_t> node_counts;  // of each
  BvhShape shape;                     // of all treelets, one after another
};

/// Sorts `items`, a few hundred neighbours, into treelets and appends these to `out`. `first_item`: the number of
/// items[0].
void shape_treelets(std::span<BvhItem> items, uint32_t first_item, Treelets& out);

/// Returns the shape of one tree over all treelets. `order` gets the numbers of the items in leaf order.
BvhShape join_treelets(std::span<const Treelets> parts, std::vector<uint32_t>& order);

/// The first elements of a tree in its sections.
struct BvhPlace {
  uint32_t first_node = 0;
  uint32_t first_item = 0;
};

/// Writes the nodes of a tree. Its leaves hold `items` in the given order, or in `order` if that is not empty. `nodes`
/// and `areas` are the whole sections, with zeros where the tree goes; `areas`, rounded to 11 bits, may be empty.
void fill_bvh(std::span<const BvhItem> items, std::span<const uint32_t> order, const BvhShape& shape,
              const BvhPlace& place, std::span<pack::BvhNode> nodes, std::span<pack::NodeArea> areas);

/// Statistics of a tree. The SAH cost is the areas of the nodes plus, of the leaves, areas times items, over the root's
/// area; 0 where the root has none. It is how many boxes and items a random line through the root's box tests on
/// average.
struct BvhStats {
  uint64_t nodes = 0;
  uint64_t leaves = 0;
  uint64_t depth = 0;  // 1 if the root is a leaf
  double sah_cost = 0;
};

/// The statistics of the tree whose root is node `first_node` of its section.
BvhStats bvh_stats(std::span<const pack::BvhNode> nodes, uint32_t first_node = 0);

void count_stats(const BvhStats& stats, PassReport& pass);

}  // namespace chandelier::baker
