// SPDX-License-Identifier: Apache-2.0
// What the tests of hierarchies share: a tree's promises, and queries that are compared with a look at every item.
#include "bvh_expect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace chandelier::baker::test {
namespace {

/// Numbers of the items whose boxes are hit, the way a GPU finds them.
std::vector<uint32_t> found(std::span<const pack::BvhNode> nodes, uint32_t first, uint32_t end, const ItemOf& item_of,
                            const Hits& hits) {
  std::vector<uint32_t> out;
  for (uint32_t i = first; i < end;) {
    const pack::BvhNode& node = nodes[i];
    if (!hits(node.bounds_min, node.bounds_max)) {
      i = node.skip;
      continue;
    }
    if (node.leaf != pack::none) {
      for (uint32_t k = node.leaf / 16; k < node.leaf / 16 + node.leaf % 16; ++k) {
        const BvhItem each = item_of(k);
        if (hits(each.low, each.high)) out.push_back(each.number);
      }
    }
    ++i;
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool ray_hits(const glm::vec3& origin, const glm::vec3& per_direction, const glm::vec3& low, const glm::vec3& high) {
  const glm::vec3 a = (low - origin) * per_direction, b = (high - origin) * per_direction;
  const glm::vec3 enter = glm::min(a, b), leave = glm::max(a, b);
  return std::max({enter.x, enter.y, enter.z, 0.0f}) <= std::min({leave.x, leave.y, leave.z});
}

}  // namespace

void expect_tree(std::span<const pack::BvhNode> nodes, std::span<const pack::NodeArea> areas, uint32_t first,
                 uint32_t end, uint32_t next_item, const ItemOf& item_of) {
  ASSERT_LT(first, end);
  ASSERT_EQ(nodes[first].skip, end);
  for (uint32_t i = first; i < end; ++i) {
    const pack::BvhNode& node = nodes[i];
    Box box{glm::vec3(largest_float), glm::vec3(-largest_float)};
    double area_m2 = 0;
    const auto add = [&](const glm::vec3& low, const glm::vec3& high, float area) {
      box.low = glm::min(box.low, low);
      box.high = glm::max(box.high, high);
      area_m2 += area;
    };
    if (node.leaf == pack::none) {
      ASSERT_LT(i + 1, node.skip);
      const uint32_t second = nodes[i + 1].skip;
      ASSERT_GT(second, i + 1);
      ASSERT_LT(second, node.skip);
      ASSERT_EQ(nodes[second].skip, node.skip);
      add(nodes[i + 1].bounds_min, nodes[i + 1].bounds_max, areas[i + 1].area_m2);
      add(nodes[second].bounds_min, nodes[second].bounds_max, areas[second].area_m2);
    } else {
      ASSERT_EQ(node.skip, i + 1);
      ASSERT_EQ(node.leaf / 16, next_item);
      ASSERT_GT(node.leaf % 16, 0u);
      for (; next_item < node.leaf / 16 + node.leaf % 16; ++next_item) {
        const BvhItem each = item_of(next_item);
        add(each.low, each.high, each.area_m2);
      }
    }
    ASSERT_EQ(node.bounds_min, box.low);
    ASSERT_EQ(node.bounds_max, box.high);
    ASSERT_NEAR(areas[i].area_m2, std::min<double>(area_m2, largest_float),
                1e-3 * std::min<double>(area_m2, largest_float));
  }
}

std::vector<Hits> random_queries(const Box& space, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-0.1f, 1.1f), direction(-1, 1);
  const auto point = [&] {
    return space.low + (space.high - space.low) * glm::vec3(unit(random), unit(random), unit(random));
  };
  std::vector<Hits> queries;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 a = point(), b = point();
    queries.push_back([low = glm::min(a, b), high = glm::max(a, b)](const glm::vec3& l, const glm::vec3& h) {
      return glm::all(glm::lessThanEqual(l, high)) && glm::all(glm::lessThanEqual(low, h));
    });
    queries.push_back([a](const glm::vec3& l, const glm::vec3& h) {
      return glm::all(glm::lessThanEqual(l, a)) && glm::all(glm::lessThanEqual(a, h));
    });
    const glm::vec3 per_direction = 1.0f / glm::vec3(direction(random), direction(random), direction(random));
    queries.push_back([=](const glm::vec3& l, const glm::vec3& h) { return ray_hits(a, per_direction, l, h); });
  }
  return queries;
}

bool expect_found(std::span<const pack::BvhNode> nodes, uint32_t first, uint32_t end, uint32_t first_item,
                  uint32_t item_count, const ItemOf& item_of, const std::vector<Hits>& queries) {
  bool any = false;
  for (const Hits& hits : queries) {
    std::vector<uint32_t> all;
    for (uint32_t i = first_item; i < first_item + item_count; ++i) {
      const BvhItem each = item_of(i);
      if (hits(each.low, each.high)) all.push_back(each.number);
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(found(nodes, first, end, item_of, hits), all);
    any = any || !all.empty();
  }
  return any;
}

}  // namespace chandelier::baker::test
