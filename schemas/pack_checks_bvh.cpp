// SPDX-License-Identifier: Apache-2.0
// The rules between fields of the hierarchies over batches, instances and triangles.
//
// That a section of nodes is a tree follows from what each node says about its children, by induction: a root's range
// is known, and an inner node's range is itself and the ranges of its two children. So no check descends a tree,
// which could be as deep as the pack is long.
#include "pack_checks_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "pack_checks_text.h"

namespace chandelier::pack {
namespace {

/// How far a node's area may differ from the sum of its children's, as a fraction of it: writers may round each to 11
/// bits.
constexpr double area_tolerance = 1e-3;

bool is_ordered(const glm::vec3& low, const glm::vec3& high) {
  return low.x <= high.x && low.y <= high.y && low.z <= high.z;
}

bool holds(const BvhNode& outer, const glm::vec3& low, const glm::vec3& high) {
  return is_ordered(outer.bounds_min, low) && is_ordered(high, outer.bounds_max);
}

bool holds(const BvhNode& outer, const BvhNode& inner) {
  return holds(outer, inner.bounds_min, inner.bounds_max);
}

/// The nodes of one section, which may hold several trees.
struct Trees {
  const char* name;
  const char* items_name;
  std::span<const BvhNode> nodes;
  uint64_t item_count;
  uint64_t next_item = 0;  // the item after those of the leaves so far
};

std::string leaf_fault(Trees& trees, uint32_t number) {
  const BvhNode& node = trees.nodes[number];
  const uint64_t first = node.leaf / 16, count = node.leaf % 16;
  if (node.skip != number + 1) return ".skip: " + text(node.skip) + " where a leaf's is " + text(number + 1u);
  if (count == 0) return ".leaf: no items (" + text(node.leaf) + ")";
  if (first != trees.next_item) {
    return ".leaf: starts with item " + text(first) + " where the leaves before it end with " + text(trees.next_item);
  }
  trees.next_item += count;
  if (trees.next_item <= trees.item_count) return {};
  return ".leaf: " + text(first) + " plus " + text(count) + " items is past the " + text(trees.item_count) + " " +
         trees.items_name;
}

/// The fault of an inner node of a tree that ends at `end`.
std::string children_fault(const Trees& trees, uint32_t number, uint32_t end) {
  const BvhNode& node = trees.nodes[number];
  if (node.skip <= number + 1 || node.skip > end) {
    return ".skip: " + text(node.skip) + " is not above its first child " + text(number + 1u) +
           " and up to the tree's end " + text(end);
  }
  const BvhNode& first = trees.nodes[number + 1];
  if (first.skip <= number + 1 || first.skip >= node.skip) {
    return ": its first child's skip " + text(first.skip) + " leaves no second child before " + text(node.skip);
  }
  const BvhNode& second = trees.nodes[first.skip];
  if (second.skip != node.skip) {
    return ".skip: " + text(node.skip) + " where that of its second child " + text(first.skip) + " is " +
           text(second.skip);
  }
  if (!holds(node, first)) return ": its box does not hold that of its first child " + text(number + 1u);
  if (!holds(node, second)) return ": its box does not hold that of its second child " + text(first.skip);
  return {};
}

/// The fault of the tree whose nodes are `first` to `end`, at least one. The items of its leaves must follow those of
/// the trees before.
std::string tree_fault(Trees& trees, uint32_t first, uint32_t end) {
  if (trees.nodes[first].skip != end) {
    return at(trees.name, first) + ".skip: " + text(trees.nodes[first].skip) + " where its tree ends at " + text(end);
  }
  for (uint32_t i = first; i < end; ++i) {
    const BvhNode& node = trees.nodes[i];
    if (!is_ordered(node.bounds_min, node.bounds_max)) {
      return at(trees.name, i) + ".bounds_min: above bounds_max";
    }
    if (std::string line = node.leaf == none ? children_fault(trees, i, end) : leaf_fault(trees, i); !line.empty()) {
      return at(trees.name, i) + line;
    }
  }
  return {};
}

/// The fault of a section that is one tree.
std::string single_tree_fault(Trees trees) {
  if (!trees.nodes.empty()) {
    std::string line = tree_fault(trees, 0, static_cast<uint32_t>(trees.nodes.size()));
    if (!line.empty()) return line;
  }
  if (trees.next_item == trees.item_count) return {};
  return std::string(trees.items_name) + ": " + text(trees.item_count) + " records where leaves have " +
         text(trees.next_item);
}

/// Checks that each n with `is_wanted[n]` is an item exactly once.
template <typename Ref>
std::string items_fault(const char* name, std::span<const Ref> items, uint32_t Ref::*number, const std::string& field,
                        const char* wanted, std::vector<bool> is_wanted) {
  const auto count = static_cast<uint64_t>(std::count(is_wanted.begin(), is_wanted.end(), true));
  for (size_t i = 0; i < items.size(); ++i) {
    const uint32_t n = items[i].*number;
    if (!is_wanted[n]) {
      return at(name, i) + "." + field + ": " + text(n) + " is there already, or is not one of the " + wanted;
    }
    is_wanted[n] = false;
  }
  if (items.size() == count) return {};
  return std::string(name) + ": " + text(items.size()) + " records for " + text(count) + " " + wanted;
}

std::string batch_boxes_fault(const View& view) {
  for (size_t i = 0; i < view.batch_bvh.size(); ++i) {
    const BvhNode& node = view.batch_bvh[i];
    if (node.leaf == none) continue;
    for (uint32_t item = node.leaf / 16; item < node.leaf / 16 + node.leaf % 16; ++item) {
      const uint32_t number = view.batch_bvh_items[item].batch_instance;
      const BatchInstance& draw = view.batch_instances[number];
      if (!holds(node, draw.bounds_min_ws, draw.bounds_max_ws)) {
        return at("batch_bvh", i) + ": its box does not hold that of batch instance " + text(number);
      }
    }
  }
  return {};
}

std::string batch_bvh_fault(const View& view) {
  if (std::string line =
          single_tree_fault({"batch_bvh", "batch_bvh_items", view.batch_bvh, view.batch_bvh_items.size()});
      !line.empty()) {
    return line;
  }
  if (view.batch_bvh.empty()) return {};
  std::vector<bool> is_static(view.batch_instances.size());
  for (size_t i = 0; i < is_static.size(); ++i) {
    is_static[i] = view.instances[view.batch_instances[i].instance].dynamic == 0;
  }
  if (std::string line = items_fault("batch_bvh_items", view.batch_bvh_items, &BatchRef::batch_instance,
                                     "batch_instance", "static batch instances", std::move(is_static));
      !line.empty()) {
    return line;
  }
  return batch_boxes_fault(view);
}

std::string instance_bvh_fault(const View& view) {
  if (std::string line =
          single_tree_fault({"instance_bvh", "instance_bvh_items", view.instance_bvh, view.instance_bvh_items.size()});
      !line.empty()) {
    return line;
  }
  if (view.instance_bvh.empty()) return {};
  std::vector<bool> is_wanted(view.instances.size());
  for (const BatchInstance& draw : view.batch_instances) {
    is_wanted[draw.instance] = view.instances[draw.instance].dynamic == 0;
  }
  return items_fault("instance_bvh_items", view.instance_bvh_items, &InstanceRef::instance, "instance",
                     "static instances with batches", std::move(is_wanted));
}

/// The fault of the items from `first` to `end`, which must be the triangles of the mesh's batches. All bits of
/// `is_open` are clear before and after.
std::string triangles_fault(const View& view, size_t m, uint64_t first, uint64_t end, std::vector<bool>& is_open) {
  const Mesh& mesh = view.meshes[m];
  uint64_t triangles = 0;
  for (uint32_t b = mesh.first_batch; b < mesh.first_batch + mesh.batch_count; ++b) {
    const Batch& batch = view.batches[b];
    triangles += batch.index_count / 3;
    if (triangles > end - first) break;  // limits the work to the number of items
    const auto begin = is_open.begin() + batch.first_index / 3;
    std::fill(begin, begin + batch.index_count / 3, true);
  }
  if (triangles != end - first) {
    return at("meshes", m) + ": its triangle BVH has " + text(end - first) + " items, not one for each triangle";
  }
  for (uint64_t i = first; i < end; ++i) {
    const uint32_t triangle = view.triangle_bvh_items[i].triangle;
    if (triangle >= is_open.size() || !is_open[triangle]) {
      return at("triangle_bvh_items", i) + ".triangle: " + text(triangle) +
             " is there already, or is not in a batch of its mesh";
    }
    is_open[triangle] = false;
  }
  return {};
}

std::string areas_fault(const View& view) {
  for (size_t i = 0; i < view.triangle_bvh.size(); ++i) {
    if (view.triangle_bvh[i].leaf != none) continue;
    const double area = view.triangle_bvh_areas[i].area_m2;
    const double sum = double{view.triangle_bvh_areas[i + 1].area_m2} +
                       double{view.triangle_bvh_areas[view.triangle_bvh[i + 1].skip].area_m2};
    const double most = std::min(sum, double{std::numeric_limits<float>::max()});
    if (std::abs(area - most) > area_tolerance * most) {
      return at("triangle_bvh_areas", i) + ".area_m2: " + text(static_cast<float>(area)) + " where its children have " +
             text(static_cast<float>(most));
    }
  }
  return {};
}

std::string triangle_bvh_fault(const View& view) {
  Trees trees{"triangle_bvh", "triangle_bvh_items", view.triangle_bvh, view.triangle_bvh_items.size()};
  uint32_t next_node = 0;
  std::vector<bool> is_open(view.triangle_bvh.empty() ? 0 : view.indices.size() / 3);
  for (size_t m = 0; m < view.meshes.size() && !view.triangle_bvh.empty(); ++m) {
    const Mesh& mesh = view.meshes[m];
    const uint64_t first_item = trees.next_item;
    if (mesh.node_count > 0) {
      if (mesh.first_node != next_node) {
        return at("meshes", m) + ".first_node: " + text(mesh.first_node) + " where the trees before it end with " +
               text(next_node);
      }
      next_node += mesh.node_count;
      if (std::string line = tree_fault(trees, mesh.first_node, next_node); !line.empty()) return line;
    }
    if (std::string line = triangles_fault(view, m, first_item, trees.next_item, is_open); !line.empty()) return line;
  }
  if (next_node != view.triangle_bvh.size()) {
    return "triangle_bvh: " + text(view.triangle_bvh.size()) + " records where meshes have " + text(next_node);
  }
  if (trees.next_item != trees.item_count) {
    return "triangle_bvh_items: " + text(trees.item_count) + " records where leaves have " + text(trees.next_item);
  }
  return areas_fault(view);
}

}  // namespace

std::string bvh_fault(const View& view) {
  for (const std::span<const BvhNode> nodes : {view.batch_bvh, view.instance_bvh, view.triangle_bvh}) {
    if (nodes.size() >= none) return "a BVH has more nodes than 32 bits count (" + text(nodes.size()) + ")";
  }
  if (std::string line = batch_bvh_fault(view); !line.empty()) return line;
  if (std::string line = instance_bvh_fault(view); !line.empty()) return line;
  return triangle_bvh_fault(view);
}

}  // namespace chandelier::pack
