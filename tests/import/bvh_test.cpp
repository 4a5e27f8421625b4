// SPDX-License-Identifier: Apache-2.0
// The builder of hierarchies on boxes made in the test: nothing lost, nothing doubled, and whatever a box, a point or a
// ray finds among all items it finds by following the nodes.
#include "bake/bvh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include "bvh_expect.h"

namespace chandelier::baker::test {
namespace {

struct Tree {
  std::vector<BvhItem> items;  // in the leaves' order
  std::vector<pack::BvhNode> nodes;
  std::vector<pack::NodeArea> areas;
};

Tree build(std::vector<BvhItem> items) {
  Tree tree{std::move(items), {}, {}};
  const BvhShape shape = shape_bvh(tree.items);
  tree.nodes.resize(shape.size());
  tree.areas.resize(shape.size());
  fill_bvh(tree.items, {}, shape, {}, tree.nodes, tree.areas);
  return tree;
}

BvhItem item(uint32_t number, const glm::vec3& low, const glm::vec3& high) {
  return {low, number, high, 1};
}

/// Boxes of sides up to `size` in a cube of side 100.
std::vector<BvhItem> random_items(uint32_t count, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0, 100), side(0, size);
  std::vector<BvhItem> items;
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 low(place(random), place(random), place(random));
    items.push_back(item(i, low, low + glm::vec3(side(random), side(random), side(random))));
  }
  return items;
}

/// And each of the `count` items once.
void expect_tree_of(const Tree& tree, size_t count) {
  ASSERT_EQ(tree.items.size(), count);
  std::vector<bool> is_there(count, false);
  for (const BvhItem& each : tree.items) {
    ASSERT_LT(each.number, count);
    ASSERT_FALSE(is_there[each.number]);
    is_there[each.number] = true;
  }
  expect_tree(tree.nodes, tree.areas, 0, static_cast<uint32_t>(tree.nodes.size()), 0,
              [&](uint32_t i) { return tree.items[i]; });
  uint64_t items = 0;
  for (const pack::BvhNode& node : tree.nodes) items += node.leaf == pack::none ? 0 : node.leaf % 16;
  ASSERT_EQ(items, count);
}

/// SAH cost of halving at the median of the longest axis, leaves of up to four.
double median_cost(std::span<BvhItem> items) {
  Box box{items[0].low, items[0].high};
  for (const BvhItem& each : items) box = {glm::min(box.low, each.low), glm::max(box.high, each.high)};
  const glm::dvec3 size = box.high - box.low;
  const double area = size.x * size.y + size.y * size.z + size.z * size.x;
  if (items.size() <= 4) return area * (1 + static_cast<double>(items.size()));
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const size_t half = items.size() / 2;
  std::nth_element(
      items.begin(), items.begin() + static_cast<ptrdiff_t>(half), items.end(),
      [&](const BvhItem& a, const BvhItem& b) { return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis]; });
  return area + median_cost(items.first(half)) + median_cost(items.subspan(half));
}

TEST(Bvh, HoldsEachItemOnceInNestedBoxes) {
  for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 6u, 15u, 16u, 17u, 100u, 1000u, 20000u}) {
    for (const float size : {0.0f, 1.0f, 60.0f}) {
      SCOPED_TRACE(testing::Message() << count << " items of " << size << " m");
      expect_tree_of(build(random_items(count, size, count)), count);
      ASSERT_FALSE(HasFatalFailure());
    }
  }
}

TEST(Bvh, OfNothingHasNoNodes) {
  EXPECT_TRUE(build({}).nodes.empty());
}

TEST(Bvh, FindsWhatALookAtEveryItemFinds) {
  for (const float size : {1.0f, 20.0f}) {
    const Tree tree = build(random_items(3000, size, 5));
    EXPECT_TRUE(expect_found(
        tree.nodes, 0, static_cast<uint32_t>(tree.nodes.size()), 0, 3000, [&](uint32_t i) { return tree.items[i]; },
        random_queries({glm::vec3(0), glm::vec3(100 + size)}, 100, 6)));
  }
}

TEST(Bvh, SeparatesWhatStandsApart) {
  std::vector<BvhItem> items = random_items(300, 1, 1);
  for (size_t i = 0; i < items.size(); i += 3) {
    items[i].low.x += 10000;
    items[i].high.x += 10000;
  }
  const Tree tree = build(items);
  const pack::BvhNode &left = tree.nodes[1], &right = tree.nodes[tree.nodes[1].skip];
  EXPECT_LT(left.bounds_max.x, 102);
  EXPECT_GE(right.bounds_min.x, 10000);
}

TEST(Bvh, CostsLessThanHalvingAtTheMedian) {
  std::mt19937 random(3);
  std::exponential_distribution<float> size(0.5f);
  std::vector<BvhItem> items = random_items(5000, 1, 2);  // most are small and some are not
  for (BvhItem& each : items) each.high += glm::vec3(size(random) * size(random), size(random) * size(random), 0.1f);
  std::vector<BvhItem> copy = items;
  const Tree tree = build(items);
  const glm::dvec3 sides = tree.nodes[0].bounds_max - tree.nodes[0].bounds_min;
  const double area = sides.x * sides.y + sides.y * sides.z + sides.z * sides.x;
  EXPECT_LT(bvh_stats(tree.nodes).sah_cost, 0.95 * median_cost(copy) / area);
}

TEST(Bvh, TakesItemsOfOneCentre) {
  for (const uint32_t count : {2u, 5u, 15u, 16u, 1000u, 40000u}) {
    SCOPED_TRACE(count);
    std::vector<BvhItem> same, nested;
    for (uint32_t i = 0; i < count; ++i) {
      same.push_back(item(i, {1, 2, 3}, {2, 3, 4}));
      nested.push_back(item(i, -glm::vec3(static_cast<float>(i)), glm::vec3(static_cast<float>(i))));
    }
    const Tree tree = build(same);
    expect_tree_of(tree, count);
    EXPECT_LE(bvh_stats(tree.nodes).depth, 30u);
    expect_tree_of(build(nested), count);
  }
}

TEST(Bvh, IsNotAsDeepAsItsItemsAre) {
  // Each item is half as far and half as large as the one before: cutting off the outermost is always best.
  std::vector<BvhItem> items;
  for (uint32_t i = 0; i < 240; ++i) {
    const float at = std::ldexp(1.0f, 120 - static_cast<int>(i));
    items.push_back(item(i, glm::vec3(at), glm::vec3(1.01f * at)));
  }
  // And a hundred thousand points that are all but one in one place.
  std::vector<BvhItem> points(100000, item(0, {0, 0, 0}, {0, 0, 0}));
  for (uint32_t i = 0; i < points.size(); ++i) points[i].number = i;
  points[70001].low = points[70001].high = {1, 0, 0};
  for (const auto& each : {items, points}) {
    const Tree tree = build(each);
    expect_tree_of(tree, each.size());
    EXPECT_LE(bvh_stats(tree.nodes).depth, 64u + 28u);
  }
}

TEST(Bvh, TakesWhatIsHugeTinyOrFlat) {
  for (const float scale : {1e-38f, 1e-20f, 1e18f, 1e30f, 3e36f}) {
    SCOPED_TRACE(scale);
    std::vector<BvhItem> items = random_items(2000, 1, 4);
    for (BvhItem& each : items) {
      each.low *= scale;
      each.high *= scale;
    }
    expect_tree_of(build(items), items.size());
  }
  std::vector<BvhItem> ends, flat = random_items(2000, 1, 4);
  for (uint32_t i = 0; i < 100; ++i)
    ends.push_back(item(i, glm::vec3(i % 2 ? -largest_float : largest_float), glm::vec3(largest_float)));
  for (BvhItem& each : flat) each.low.y = each.high.y = 7;
  expect_tree_of(build(ends), ends.size());
  expect_tree_of(build(flat), flat.size());
}

/// Groups of 90 neighbours, treelets of each in `parts` blocks, one tree.
Tree build_of_treelets(std::vector<BvhItem> items, size_t parts) {
  constexpr size_t group = 90;
  shape_bvh(items);  // neighbours side by side
  std::vector<Treelets> treelets(parts);
  for (size_t first = 0; first < items.size(); first += group) {
    shape_treelets(std::span(items).subspan(first, std::min(group, items.size() - first)), static_cast<uint32_t>(first),
                   treelets[first * parts / items.size()]);
  }
  std::vector<uint32_t> order;
  const BvhShape shape = join_treelets(treelets, order);
  Tree tree;
  tree.nodes.resize(shape.size());
  tree.areas.resize(shape.size());
  fill_bvh(items, order, shape, {}, tree.nodes, tree.areas);
  for (const uint32_t number : order) tree.items.push_back(items[number]);
  return tree;
}

TEST(Bvh, OfTreeletsCostsLittleMoreThanOfItems) {
  for (const uint32_t count : {1u, 32u, 33u, 90u, 1000u, 100000u}) {
    SCOPED_TRACE(count);
    const std::vector<BvhItem> items = random_items(count, 1, 5);
    const Tree tree = build_of_treelets(items, 3);
    expect_tree_of(tree, count);
    EXPECT_LT(bvh_stats(tree.nodes).sah_cost, 1.1 * bvh_stats(build(items).nodes).sah_cost);
  }
  EXPECT_TRUE(build_of_treelets({}, 2).nodes.empty());
}

TEST(Bvh, OfTreeletsTakesWhatCannotBeCut) {
  std::vector<BvhItem> same, ends;
  for (uint32_t i = 0; i < 20000; ++i) {
    same.push_back(item(i, {1, 2, 3}, {2, 3, 4}));
    ends.push_back(item(i, glm::vec3(i % 2 ? -largest_float : largest_float), glm::vec3(largest_float)));
  }
  expect_tree_of(build_of_treelets(same, 1), same.size());
  expect_tree_of(build_of_treelets(ends, 1), ends.size());
}

TEST(Bvh, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<BvhItem> items = random_items(200000, 3, 9);
  const auto build_with = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return build(items);
  };
  const Tree one = build_with(1), four = build_with(4);
  EXPECT_TRUE(same_bytes(one.nodes, four.nodes));
  EXPECT_TRUE(same_bytes(one.areas, four.areas));
  EXPECT_TRUE(same_bytes(one.items, four.items));
}

TEST(BvhStats, CountACostThatCanBeCountedByHand) {
  // Two unit cubes with a unit gap: the root has 3 + 3 + 1, each leaf 3 (half areas).
  const Tree tree = build({item(0, {0, 0, 0}, {1, 1, 1}), item(1, {2, 0, 0}, {3, 1, 1})});
  const BvhStats stats = bvh_stats(tree.nodes);
  EXPECT_EQ(stats.nodes, 3u);
  EXPECT_EQ(stats.leaves, 2u);
  EXPECT_EQ(stats.depth, 2u);
  EXPECT_DOUBLE_EQ(stats.sah_cost, (7.0 + 2 * 3.0 * (1 + 1)) / 7.0);
}

}  // namespace
}  // namespace chandelier::baker::test
