// SPDX-License-Identifier: Apache-2.0
// What a reader promises about the hierarchies over batches, instances and triangles: each rule broken once.
#include <gtest/gtest.h>

#include <limits>

#include "pack_breach.h"

namespace chandelier::pack::test {
namespace {

/// Halves the first leaf of batch_bvh: ((0 2) (1 3)) becomes (((0) (2)) (1 3)).
void deepen(Contents& c) {
  const BvhNode left = c.batch_bvh[1], right = c.batch_bvh[2];
  c.batch_bvh = {{left.bounds_min, 5, right.bounds_max, none},
                 {left.bounds_min, 4, left.bounds_max, none},
                 {left.bounds_min, 3, left.bounds_max, 0 * 16 + 1},
                 {left.bounds_min, 4, left.bounds_max, 1 * 16 + 1},
                 {right.bounds_min, 5, right.bounds_max, 2 * 16 + 2}};
}

const Breach breaches[] = {
    // Trees
    {"RootEndsEarly", [](Contents& c) { c.batch_bvh[0].skip = 2; }, "batch_bvh[0].skip: 2 where its tree ends at 3"},
    {"RootEndsLate", [](Contents& c) { c.instance_bvh[0].skip = none; },
     "instance_bvh[0].skip: 4294967295 where its tree ends at 3"},
    {"LeafEndsLate", [](Contents& c) { c.batch_bvh[1].skip = 3; },
     "batch_bvh[0]: its first child's skip 3 leaves no second child before 3"},
    {"LeafIsALoop", [](Contents& c) { c.batch_bvh[1].skip = 0; },
     "batch_bvh[0]: its first child's skip 0 leaves no second child before 3"},
    {"LeafSkipsItself", [](Contents& c) { c.batch_bvh[1].skip = 1; },
     "batch_bvh[0]: its first child's skip 1 leaves no second child before 3"},
    {"SecondChildEndsElsewhere", [](Contents& c) { c.batch_bvh[2].skip = 1; },
     "batch_bvh[0].skip: 3 where that of its second child 2 is 1"},
    {"OnlyNodeIsInner",
     [](Contents& c) {
       c.batch_bvh = {{{-2, 0, -0.5f}, 1, {3, 1, 0}, none}};
     },
     "batch_bvh[0].skip: 1 is not above its first child 1 and up to the tree's end 1"},
    {"LastNodeIsInner", [](Contents& c) { c.batch_bvh[2].leaf = none; },
     "batch_bvh[2].skip: 3 is not above its first child 3 and up to the tree's end 3"},
    {"LeafHasNodes",
     [](Contents& c) {
       deepen(c);
       c.batch_bvh[1].leaf = 0 * 16 + 1;
     },
     "batch_bvh[1].skip: 4 where a leaf's is 2"},
    {"InnerNodeEndsLate",
     [](Contents& c) {
       deepen(c);
       c.batch_bvh[1].skip = 5;
     },
     "batch_bvh[0]: its first child's skip 5 leaves no second child before 5"},
    {"InnerNodeEndsEarly",
     [](Contents& c) {
       deepen(c);
       c.batch_bvh[1].skip = 3;
     },
     "batch_bvh[0].skip: 5 where that of its second child 3 is 4"},
    // Boxes
    {"BoxUpsideDown", [](Contents& c) { c.batch_bvh[0].bounds_min.y = 1.5f; },
     "batch_bvh[0].bounds_min: above bounds_max"},
    {"FirstChildOutside", [](Contents& c) { c.instance_bvh[1].bounds_min.x = -2.5f; },
     "instance_bvh[0]: its box does not hold that of its first child 1"},
    {"SecondChildOutside", [](Contents& c) { c.triangle_bvh[2].bounds_max.z = 0.5f; },
     "triangle_bvh[0]: its box does not hold that of its second child 2"},
    {"BatchOutside", [](Contents& c) { c.batch_bvh[1].bounds_min.z = -0.25f; },
     "batch_bvh[1]: its box does not hold that of batch instance 2"},
    // Items
    {"EmptyLeaf", [](Contents& c) { c.batch_bvh[2].leaf = 2 * 16; }, "batch_bvh[2].leaf: no items (32)"},
    {"LeafTakesItemsTwice", [](Contents& c) { c.batch_bvh[2].leaf = 1 * 16 + 3; },
     "batch_bvh[2].leaf: starts with item 1 where the leaves before it end with 2"},
    {"LeafLeavesItemsOut", [](Contents& c) { c.instance_bvh[2].leaf = 2 * 16 + 1; },
     "instance_bvh[2].leaf: starts with item 2 where the leaves before it end with 1"},
    {"LeafPastTheItems", [](Contents& c) { c.batch_bvh[2].leaf = 2 * 16 + 15; },
     "batch_bvh[2].leaf: 2 plus 15 items is past the 4 batch_bvh_items"},
    {"LeafFarPastTheItems", [](Contents& c) { c.batch_bvh[2].leaf = none - 1; },
     "batch_bvh[2].leaf: starts with item 268435455 where the leaves before it end with 2"},
    {"ItemsAfterTheLastLeaf", [](Contents& c) { c.batch_bvh_items.push_back({4}); },
     "batch_bvh_items: 5 records where leaves have 4"},
    {"ItemsWithoutNodes", [](Contents& c) { c.instance_bvh.clear(); },
     "instance_bvh_items: 2 records where leaves have 0"},
    {"BatchTwice", [](Contents& c) { c.batch_bvh_items[1] = c.batch_bvh_items[0]; },
     "batch_bvh_items[1].batch_instance: 0 is there already, or is not one of the static batch instances"},
    {"DynamicBatch", [](Contents& c) { c.batch_bvh_items[3] = {4}; },
     "batch_bvh_items[3].batch_instance: 4 is there already, or is not one of the static batch instances"},
    {"BatchMissing",
     [](Contents& c) {
       c.batch_bvh_items.pop_back();
       c.batch_bvh[2].leaf = 2 * 16 + 1;
     },
     "batch_bvh_items: 3 records for 4 static batch instances"},
    {"BatchBecomesDynamic", [](Contents& c) { c.instances[0].dynamic = 1; },
     "batch_bvh_items[0].batch_instance: 0 is there already, or is not one of the static batch instances"},
    {"InstanceTwice", [](Contents& c) { c.instance_bvh_items[1] = c.instance_bvh_items[0]; },
     "instance_bvh_items[1].instance: 0 is there already, or is not one of the static instances with batches"},
    {"DynamicInstance", [](Contents& c) { c.instance_bvh_items[0] = {2}; },
     "instance_bvh_items[0].instance: 2 is there already, or is not one of the static instances with batches"},
    {"InstanceMissing",
     [](Contents& c) {
       c.instance_bvh_items.pop_back();
       c.instance_bvh = {{{-2, 0, -0.5f}, 1, {3, 1, 0}, 0 * 16 + 1}};
     },
     "instance_bvh_items: 1 records for 2 static instances with batches"},
    // Triangles of each mesh
    {"MeshesShareNodes",
     [](Contents& c) {
       c.meshes[1].first_node = 2;
       c.meshes[1].node_count = 2;
     },
     "meshes[1].first_node: 2 where the trees before it end with 3"},
    {"MeshWithoutNodes", [](Contents& c) { c.meshes[1].node_count = 0; },
     "meshes[1]: its triangle BVH has 0 items, not one for each triangle"},
    {"MeshOfFewerNodes", [](Contents& c) { c.meshes[0].node_count = 2; },
     "triangle_bvh[0].skip: 3 where its tree ends at 2"},
    {"NodesOfNoMesh",
     [](Contents& c) {
       c.triangle_bvh.push_back(c.triangle_bvh[3]);
       c.triangle_bvh_areas.push_back({1});
     },
     "triangle_bvh: 5 records where meshes have 4"},
    {"TriangleItemsOfNoNode", [](Contents& c) { c.triangle_bvh_items.push_back({0}); },
     "triangle_bvh_items: 4 records where leaves have 3"},
    {"TriangleOfAnotherMesh", [](Contents& c) { c.triangle_bvh_items[0] = {2}; },
     "triangle_bvh_items[0].triangle: 2 is there already, or is not in a batch of its mesh"},
    {"TriangleTwice", [](Contents& c) { c.triangle_bvh_items[1] = {0}; },
     "triangle_bvh_items[1].triangle: 0 is there already, or is not in a batch of its mesh"},
    {"TrianglePastTheIndices", [](Contents& c) { c.triangle_bvh_items[2] = {none}; },
     "triangle_bvh_items[2].triangle: 4294967295 is there already, or is not in a batch of its mesh"},
    {"TriangleMissing",
     [](Contents& c) {
       c.meshes[0].batch_count = 3;
       c.meshes[0].vertex_count = 7;
     },
     "meshes[0]: its triangle BVH has 2 items, not one for each triangle"},
    {"AreaTooLarge", [](Contents& c) { c.triangle_bvh_areas[0] = {4}; },
     "triangle_bvh_areas[0].area_m2: 4 where its children have 1.1123724"},
    {"AreaTooSmall", [](Contents& c) { c.triangle_bvh_areas[1] = {2}; },
     "triangle_bvh_areas[0].area_m2: 1.1123724 where its children have 2.6123724"},
};

class PackBvhRules : public testing::TestWithParam<Breach> {};

TEST_P(PackBvhRules, BreachIsNamed) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Each, PackBvhRules, testing::ValuesIn(breaches), name_of_breach);

TEST(PackBvhRulesLimits, TreesOfAnyDepthAreAllowed) {
  Contents contents = sample();
  deepen(contents);
  EXPECT_EQ(check(view_of(contents)), "");
}

TEST(PackBvhRulesLimits, APackMayHaveNoHierarchies) {
  Contents contents = sample();
  contents.batch_bvh.clear();
  contents.batch_bvh_items.clear();
  EXPECT_EQ(check(view_of(contents)), "");
  contents.instance_bvh.clear();
  contents.instance_bvh_items.clear();
  contents.triangle_bvh.clear();
  contents.triangle_bvh_items.clear();
  contents.triangle_bvh_areas.clear();
  for (Mesh& mesh : contents.meshes) mesh.first_node = mesh.node_count = 0;
  EXPECT_EQ(check(view_of(contents)), "");
}

TEST(PackBvhRulesLimits, AreasMayEndAtTheGreatestFloat) {
  Contents contents = sample();
  const float most = std::numeric_limits<float>::max();
  contents.triangle_bvh_areas = {{most}, {most}, {most}, {1}};
  EXPECT_EQ(check(view_of(contents)), "");
}

// A path of a million nodes: each inner node has one leaf and the rest. Neither it nor a fault at its end may overflow
// the stack.
TEST(PackBvhRulesLimits, ATreeMayBeAPath) {
  constexpr uint32_t leaves = 500000;
  Contents contents = sample();
  contents.instance_bvh.clear();
  contents.instance_bvh_items.clear();
  contents.batch_instances.assign(leaves, contents.batch_instances[0]);
  contents.batch_bvh.clear();
  contents.batch_bvh_items.clear();
  const BatchInstance& draw = contents.batch_instances[0];
  for (uint32_t i = 0; i < leaves; ++i) {
    if (i + 1 < leaves) contents.batch_bvh.push_back({draw.bounds_min_ws, 2 * leaves - 1, draw.bounds_max_ws, none});
    const auto number = static_cast<uint32_t>(contents.batch_bvh.size());
    contents.batch_bvh.push_back({draw.bounds_min_ws, number + 1, draw.bounds_max_ws, i * 16 + 1});
    contents.batch_bvh_items.push_back({i});
  }
  EXPECT_EQ(check(view_of(contents)), "");
  contents.batch_bvh.back().leaf += 16;
  EXPECT_EQ(check(view_of(contents)),
            "batch_bvh[999998].leaf: starts with item 500000 where the leaves before it end with 499999");
}

}  // namespace
}  // namespace chandelier::pack::test
