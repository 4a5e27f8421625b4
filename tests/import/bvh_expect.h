// SPDX-License-Identifier: Apache-2.0
// What the tests of hierarchies share: a tree's promises, and queries that are compared with a look at every item.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "bake/bvh.h"

namespace chandelier::baker::test {

constexpr float largest_float = std::numeric_limits<float>::max();

struct Box {
  glm::vec3 low, high;
};

using ItemOf = std::function<BvhItem(uint32_t item)>;

/// What a tree promises whose nodes are `first` to `end` in `nodes`: two children in each inner node, boxes that are
/// just as large as what they hold, areas that are sums, leaves one after another from item `next_item` on.
void expect_tree(std::span<const pack::BvhNode> nodes, std::span<const pack::NodeArea> areas, uint32_t first,
                 uint32_t end, uint32_t next_item, const ItemOf& item_of);

/// Whether a query hits a box.
using Hits = std::function<bool(const glm::vec3& low, const glm::vec3& high)>;

/// Boxes, points and rays in and around a space.
std::vector<Hits> random_queries(const Box& space, int count, unsigned seed);

/// Compares what each query finds by following the nodes, as a GPU does, with a look at every item; true if any query
/// found anything.
bool expect_found(std::span<const pack::BvhNode> nodes, uint32_t first, uint32_t end, uint32_t first_item,
                  uint32_t item_count, const ItemOf& item_of, const std::vector<Hits>& queries);

template <typename Record>
bool same_bytes(const std::vector<Record>& a, const std::vector<Record>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), std::span(a).size_bytes()) == 0);
}

}  // namespace chandelier::baker::test
