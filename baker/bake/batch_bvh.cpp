// SPDX-License-Identifier: Apache-2.0
// Hierarchies over static batch instances and static instances.
#include "batch_bvh.h"

#include <glm/glm.hpp>

#include "bvh.h"
#include "is_static.h"

namespace chandelier::baker {
namespace {

/// Boxes of all static instances that draw anything, in their order.
std::vector<BvhItem> instance_items(const pack::Contents& pack) {
  std::vector<BvhItem> all(pack.instances.size());
  std::vector<bool> is_drawn(pack.instances.size(), false);
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    if (!is_static(pack, draw)) continue;
    BvhItem& item = all[draw.instance];
    const bool first = !is_drawn[draw.instance];
    item.low = first ? draw.bounds_min_ws : glm::min(item.low, draw.bounds_min_ws);
    item.high = first ? draw.bounds_max_ws : glm::max(item.high, draw.bounds_max_ws);
    item.number = draw.instance;
    is_drawn[draw.instance] = true;
  }
  std::vector<BvhItem> items;
  for (size_t i = 0; i < all.size(); ++i) {
    if (is_drawn[i]) items.push_back(all[i]);
  }
  return items;
}

/// The tree over `items`; `refs` gets their owners.
template <typename Ref>
void make_bvh(std::vector<BvhItem>& items, std::vector<pack::BvhNode>& nodes, std::vector<Ref>& refs,
              PassReport& pass) {
  const BvhShape shape = shape_bvh(items);
  nodes.assign(shape.size(), {});
  fill_bvh(items, {}, shape, {}, nodes, {});
  refs.clear();
  refs.reserve(items.size());
  for (const BvhItem& item : items) refs.push_back({item.number});
  pass.bytes = std::span(nodes).size_bytes() + std::span(refs).size_bytes();
  pass.count("items", static_cast<double>(items.size()));
  count_stats(bvh_stats(nodes), pass);
}

}  // namespace

void make_batch_bvh(PassReport& pass, pack::Contents& pack) {
  std::vector<BvhItem> items;
  items.reserve(pack.batch_instances.size());
  for (size_t i = 0; i < pack.batch_instances.size(); ++i) {
    const pack::BatchInstance& draw = pack.batch_instances[i];
    if (is_static(pack, draw)) {
      items.push_back({draw.bounds_min_ws, static_cast<uint32_t>(i), draw.bounds_max_ws, 0});
    }
  }
  make_bvh(items, pack.batch_bvh, pack.batch_bvh_items, pass);
}

void make_instance_bvh(PassReport& pass, pack::Contents& pack) {
  std::vector<BvhItem> items = instance_items(pack);
  make_bvh(items, pack.instance_bvh, pack.instance_bvh_items, pass);
}

}  // namespace chandelier::baker
