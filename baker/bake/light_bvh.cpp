// SPDX-License-Identifier: Apache-2.0
// Top down: split the lights where lights × sphere, summed over both sides, is least (the surface area heuristic with
// spheres in place of boxes), by their centres along an axis or by their radii. A tree over n lights has 2 n − 1 nodes
// in any order of splits, so each part knows where it goes and both halves are built at the same time.
#include "light_bvh.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "light_bounds.h"

namespace chandelier::baker {
namespace {

constexpr int bin_count = 16;
constexpr int keys = 4;             // x, y, z, and the radius's logarithm
constexpr int most_uneven = 64;     // uneven splits in a row before halving: a tree is at most this plus log2 n deep
constexpr size_t parallel = 2048;   // lights that are worth a task of their own
constexpr size_t refine_steps = 8;  // of a node's sphere

struct Item {
  Sphere sphere;
  double log_radius;
  uint32_t light;
};
using Items = std::span<Item>;

double key_of(const Item& item, int key) {
  return key < 3 ? item.sphere.center[key] : item.log_radius;
}

/// An upper bound of the radius of the sphere around some lights: half the diagonal of their centres' box, and their
/// largest radius.
struct Extent {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
  double radius = 0;
  size_t count = 0;

  void add(const Item& item) {
    low = glm::min(low, item.sphere.center);
    high = glm::max(high, item.sphere.center);
    radius = std::max(radius, item.sphere.radius);
    ++count;
  }
  void add(const Extent& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
    radius = std::max(radius, other.radius);
    count += other.count;
  }
  double cost() const {
    const double bound = 0.5 * glm::length(high - low) + radius;
    return static_cast<double>(count) * bound * bound;
  }
};

struct Split {
  double cost = INFINITY;
  int key = 0, bin = 0;
  double low = 0, scale = 0;

  int bin_of(const Item& item) const {
    return std::clamp(static_cast<int>((key_of(item, key) - low) * scale), 0, bin_count - 1);
  }
};

/// The best of a key's 15 splits; infinite cost where all items fall into one bin.
Split split_by(int key, Items items) {
  double least = INFINITY, most = -INFINITY;
  for (const Item& item : items) {
    least = std::min(least, key_of(item, key));
    most = std::max(most, key_of(item, key));
  }
  Split split{.key = key, .low = least, .scale = bin_count / (most - least)};
  if (!std::isfinite(split.scale)) return split;
  std::array<Extent, bin_count> bins, above;
  for (const Item& item : items) bins[static_cast<size_t>(split.bin_of(item))].add(item);
  for (size_t i = bin_count - 1; i > 0; --i) {
    above[i - 1] = above[i];
    above[i - 1].add(bins[i]);
  }
  Extent below;
  for (size_t i = 0; i + 1 < bin_count; ++i) {
    below.add(bins[i]);
    if (below.count == 0 || above[i].count == 0) continue;
    const double cost = below.cost() + above[i].cost();
    if (cost < split.cost) split.cost = cost, split.bin = static_cast<int>(i);
  }
  return split;
}

/// Puts the items of the first half in front, and returns how many they are. Stable, so that results repeat.
size_t partition(Items items, int depth) {
  Split best;
  for (int key = 0; key < keys && depth < most_uneven; ++key) {
    const Split split = split_by(key, items);
    if (split.cost < best.cost) best = split;
  }
  if (!std::isfinite(best.cost)) return items.size() / 2;
  const auto is_first = [&](const Item& item) { return best.bin_of(item) <= best.bin; };
  return static_cast<size_t>(std::stable_partition(items.begin(), items.end(), is_first) - items.begin());
}

double radius_around(const glm::dvec3& center, Items items, const Item*& farthest) {
  double radius = -1;
  for (const Item& item : items) {
    const double reach = glm::distance(center, item.sphere.center) + item.sphere.radius;
    if (reach > radius) radius = reach, farthest = &item;
  }
  return radius;
}

/// A small sphere around all: from a first guess, the centre moves towards the farthest light, in shrinking steps
/// (Badoiu and Clarkson 2003); the best step counts.
Sphere sphere_around(Items items, const Sphere& guess) {
  Sphere best = guess;
  glm::dvec3 center = guess.center;
  for (size_t step = 1; step <= refine_steps; ++step) {
    const Item* farthest = nullptr;
    const double radius = radius_around(center, items, farthest);
    if (radius < best.radius) best = {center, radius};
    const glm::dvec3 apart = farthest->sphere.center - center;
    const double distance = glm::length(apart);
    if (distance == 0) break;
    center += apart * (radius / distance / static_cast<double>(step + 1));
  }
  return best;
}

pack::LightBvhNode node_of(const Sphere& sphere, size_t miss, uint32_t light) {
  const FloatSphere rounded = rounded_outwards(sphere);
  return {rounded.center, rounded.radius, static_cast<uint32_t>(miss), light};
}

/// Fills 2 · items − 1 nodes from `first` on; returns the root's sphere.
Sphere build(Items items, size_t first, int depth, std::span<pack::LightBvhNode> nodes) {
  const size_t end = first + 2 * items.size() - 1;
  if (items.size() == 1) {
    nodes[first] = node_of(items[0].sphere, end, items[0].light);
    return items[0].sphere;
  }
  const size_t half = partition(items, depth);
  Sphere left, right;
  const auto build_left = [&] { left = build(items.first(half), first + 1, depth + 1, nodes); };
  const auto build_right = [&] { right = build(items.subspan(half), first + 2 * half, depth + 1, nodes); };
  if (items.size() >= parallel) {
    tbb::parallel_invoke(build_left, build_right);
  } else {
    build_left();
    build_right();
  }
  const Sphere sphere = sphere_around(items, enclosing(left, right));
  nodes[first] = node_of(sphere, end, pack::none);
  return sphere;
}

}  // namespace

std::vector<pack::LightBvhNode> build_light_bvh(std::span<const pack::Light> lights) {
  std::vector<Item> items;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].type == pack::LightType::directional) continue;
    const double radius = lights[i].bounds_radius_m;
    items.push_back({{glm::dvec3(lights[i].bounds_center_ws), radius},
                     std::log(std::max(radius, 1e-30)),
                     static_cast<uint32_t>(i)});
  }
  if (items.empty()) return {};
  std::vector<pack::LightBvhNode> nodes(2 * items.size() - 1);
  build(items, 0, 0, nodes);
  return nodes;
}

}  // namespace chandelier::baker
