// SPDX-License-Identifier: Apache-2.0
// Binary bounding volume hierarchies by the surface area heuristic (SAH): what batches, instances and triangles share.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "../report.h"
#include "bvh_item.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// A tree's shape, depth first, a byte a node: the items of a leaf, 0 for an inner node.
using BvhShape = std::vector<uint8_t>;

/// Most items of all trees in a section: BvhNode::leaf has 28 bits for an item's number.
constexpr uint64_t most_bvh_items = (1u << 28) - 1;

/// What four bits of BvhNode::leaf hold.
constexpr size_t most_leaf_items = 15;

/// Sorts `items` into the order of the leaves and returns the shape of the tree over them; nothing for no items. Uses
/// all threads where there are many items; the result does not depend on them.
BvhShape shape_bvh(std::span<BvhItem> items, size_t most_leaf = most_leaf_items);

/// The lower parts of a tree, each over up to 32 neighbours.
struct Treelets {
  std::vector<BvhItem> boxes;         // `number`: of the treelet's first item
  std::vector<uint32_t> item_counts;  // of each
  std::vector<uint32_t> node_counts;  // of each
  BvhShape shape;                     // of each, one after another
};

/// Sorts `items`, some hundred neighbours, into treelets, and appends these. `first_item`: the number of items[0].
void shape_treelets(std::span<BvhItem> items, uint32_t first_item, Treelets& out);

/// The shape of one tree with all treelets; in `order` the numbers of items in the order of its leaves.
BvhShape join_treelets(std::span<const Treelets> parts, std::vector<uint32_t>& order);

/// Where a tree stands in its sections.
struct BvhPlace {
  uint32_t first_node = 0;
  uint32_t first_item = 0;
};

/// Writes the nodes of a shape over items in its order, or in `order`, if there is one. `nodes` and `areas` are the
/// whole sections, with zeros where the tree goes; `areas`, rounded to 11 bits, may be empty.
void fill_bvh(std::span<const BvhItem> items, std::span<const uint32_t> order, const BvhShape& shape,
              const BvhPlace& place, std::span<pack::BvhNode> nodes, std::span<pack::NodeArea> areas);

/// A tree's counts. Its SAH cost: the areas of the nodes plus, of the leaves, areas times items, over the root's area;
/// 0 where the root has none. It is how many boxes and items a random line through the root's box tests on average.
struct BvhStats {
  uint64_t nodes = 0;
  uint64_t leaves = 0;
  uint64_t depth = 0;  // 1 for a leaf alone
  double sah_cost = 0;
};

/// Of one tree, whose root is `first_node` in its section.
BvhStats bvh_stats(std::span<const pack::BvhNode> nodes, uint32_t first_node = 0);

void count_stats(const BvhStats& stats, PassReport& pass);

}  // namespace chandelier::baker
