// SPDX-License-Identifier: Apache-2.0
// A hierarchy over each mesh's triangles. Shapes of all trees first; when their sizes are known, the nodes are written
// where they belong.
#include "triangle_bvh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "../error.h"
#include "bvh.h"

namespace chandelier::baker {
namespace {

constexpr size_t task_batches = 64;

struct Tree {
  BvhPlace place;
  std::span<BvhItem> items;
  std::vector<uint32_t> order;  // of items in the leaves
  BvhShape shape;
};

uint32_t triangle_count(const pack::Batch& batch) {
  return batch.index_count / 3;
}

uint64_t triangle_count(const pack::Contents& pack, const pack::Mesh& mesh) {
  uint64_t count = 0;
  for (uint32_t b = 0; b < mesh.batch_count; ++b) count += triangle_count(pack.batches[mesh.first_batch + b]);
  return count;
}

BvhItem item_of(const pack::Contents& pack, uint32_t triangle) {
  const auto corner = [&](size_t c) -> const glm::vec3& {
    return pack.positions[pack.indices[size_t{triangle} * 3 + c].vertex].position_ls;
  };
  const glm::vec3 &a = corner(0), &b = corner(1), &c = corner(2);
  const double area_m2 = 0.5 * glm::length(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
  return {glm::min(glm::min(a, b), c), triangle, glm::max(glm::max(a, b), c),
          static_cast<float>(std::min<double>(area_m2, std::numeric_limits<float>::max()))};
}

/// Treelets of each batch, in blocks of batches, and one tree over them all.
void shape_tree(const pack::Contents& pack, const pack::Mesh& mesh, Tree& tree) {
  const std::span batches = std::span(pack.batches).subspan(mesh.first_batch, mesh.batch_count);
  std::vector<uint32_t> first_items(batches.size());
  uint32_t next = 0;
  for (size_t b = 0; b < batches.size(); ++b) {
    first_items[b] = next;
    next += triangle_count(batches[b]);
  }
  std::vector<Treelets> parts((batches.size() + task_batches - 1) / task_batches);
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t part) {
    for (size_t b = part * task_batches; b < std::min(batches.size(), (part + 1) * task_batches); ++b) {
      const std::span items = tree.items.subspan(first_items[b], triangle_count(batches[b]));
      for (uint32_t t = 0; t < items.size(); ++t) items[t] = item_of(pack, batches[b].first_index / 3 + t);
      shape_treelets(items, first_items[b], parts[part]);
    }
  });
  tree.shape = join_treelets(parts, tree.order);
}

/// Where each mesh's items go; returns their count.
uint32_t place_items(const pack::Contents& pack, std::vector<Tree>& trees) {
  uint64_t items = 0;
  for (size_t m = 0; m < trees.size(); ++m) {
    trees[m].place.first_item = static_cast<uint32_t>(items);
    items += triangle_count(pack, pack.meshes[m]);
    if (items > most_bvh_items) {
      fail("scene", "has more triangles than triangle BVHs can hold (above " + std::to_string(most_bvh_items) + ")");
    }
  }
  return static_cast<uint32_t>(items);
}

/// Where each mesh's nodes go; returns their count, which fits: a tree has less than two nodes an item.
uint32_t place_nodes(std::vector<Tree>& trees, std::vector<pack::Mesh>& meshes) {
  uint32_t nodes = 0;
  for (size_t m = 0; m < trees.size(); ++m) {
    trees[m].place.first_node = meshes[m].first_node = nodes;
    meshes[m].node_count = static_cast<uint32_t>(trees[m].shape.size());
    nodes += meshes[m].node_count;
  }
  return nodes;
}

/// Fills the sections with zeros, in parallel, since clearing memory takes long.
void make_room(uint32_t nodes, uint32_t items, pack::Contents& pack) {
  tbb::parallel_invoke([&] { pack.triangle_bvh.assign(nodes, {}); },
                       [&] {
                         pack.triangle_bvh_items.assign(items, {});
                         pack.triangle_bvh_areas.assign(nodes, {});
                       });
}

void fill_tree(const Tree& tree, pack::Contents& pack) {
  fill_bvh(tree.items, tree.order, tree.shape, tree.place, pack.triangle_bvh, pack.triangle_bvh_areas);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, tree.items.size(), 16384), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      pack.triangle_bvh_items[tree.place.first_item + i].triangle = tree.items[tree.order[i]].number;
    }
  });
}

/// Over all meshes; the SAH cost is the mean over triangles.
void note(const pack::Contents& pack, const std::vector<Tree>& trees, PassReport& pass) {
  std::vector<BvhStats> each(trees.size());
  tbb::parallel_for(size_t{0}, trees.size(), [&](size_t m) {
    const pack::Mesh& mesh = pack.meshes[m];
    each[m] = bvh_stats(std::span(pack.triangle_bvh).subspan(mesh.first_node, mesh.node_count), mesh.first_node);
  });
  BvhStats all;
  for (size_t m = 0; m < trees.size(); ++m) {
    all.nodes += each[m].nodes;
    all.leaves += each[m].leaves;
    all.depth = std::max(all.depth, each[m].depth);
    all.sah_cost += each[m].sah_cost * static_cast<double>(trees[m].items.size());
  }
  if (!pack.triangle_bvh_items.empty()) all.sah_cost /= static_cast<double>(pack.triangle_bvh_items.size());
  pass.bytes = std::span(pack.triangle_bvh).size_bytes() + std::span(pack.triangle_bvh_items).size_bytes() +
               std::span(pack.triangle_bvh_areas).size_bytes();
  pass.count("items", static_cast<double>(pack.triangle_bvh_items.size()));
  count_stats(all, pass);
}

}  // namespace

void make_triangle_bvh(PassReport& pass, pack::Contents& pack) {
  std::vector<Tree> trees(pack.meshes.size());
  const uint32_t item_count = place_items(pack, trees);
  const auto items = std::make_unique_for_overwrite<BvhItem[]>(item_count);
  tbb::parallel_for(size_t{0}, trees.size(), [&](size_t m) {
    Tree& tree = trees[m];
    tree.items = {items.get() + tree.place.first_item, triangle_count(pack, pack.meshes[m])};
    shape_tree(pack, pack.meshes[m], tree);
  });
  make_room(place_nodes(trees, pack.meshes), item_count, pack);
  tbb::parallel_for(size_t{0}, trees.size(), [&](size_t m) { fill_tree(trees[m], pack); });
  note(pack, trees, pass);
}

}  // namespace chandelier::baker
