// SPDX-License-Identifier: Apache-2.0
// Instances and batch instances; boxes from the batches' own vertices, so that rotation does not widen them.
#include "instances.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "../error.h"

namespace chandelier::baker {
namespace {

/// The number of the mesh's record in the pack, or no_index.
uint32_t record_of(const MeshInstance& instance, const std::vector<MeshRecords>& meshes) {
  return is_mirrored(instance) ? meshes[instance.mesh].mirrored : meshes[instance.mesh].plain;
}

pack::Instance instance_record(const MeshInstance& instance, uint32_t mesh, Strings& strings) {
  pack::Instance out;
  out.mesh = mesh;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out.world_from_local[row][column] = static_cast<float>(instance.world_from_local[column][row]);
    }
  }
  out.node = instance.node;
  out.skin = instance.skin;
  out.dynamic = instance.node != no_index || instance.skin != no_index;
  out.shadowless = instance.shadowless;
  out.name = strings.add(instance.name);
  return out;
}

/// Uses the pack's matrix, not the one before rounding.
glm::dvec3 to_world(const pack::Instance& instance, const glm::vec3& local) {
  const glm::dvec4 p(local, 1);
  return {glm::dot(glm::dvec4(instance.world_from_local[0]), p), glm::dot(glm::dvec4(instance.world_from_local[1]), p),
          glm::dot(glm::dvec4(instance.world_from_local[2]), p)};
}

/// The nearest float that is not above, and the nearest that is not below.
float float_below(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} > value ? std::nextafter(nearest, -INFINITY) : nearest;
}
float float_above(double value) {
  return -float_below(-value);
}

void set_bounds(const pack::Contents& pack, pack::BatchInstance& record) {
  const pack::Batch& batch = pack.batches[record.batch];
  const pack::Instance& instance = pack.instances[record.instance];
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (uint32_t i = 0; i < batch.index_count; ++i) {
    const glm::dvec3 p = to_world(instance, pack.positions[pack.indices[batch.first_index + i].vertex].position_ls);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  record.bounds_min_ws = {float_below(low.x), float_below(low.y), float_below(low.z)};
  record.bounds_max_ws = {float_above(high.x), float_above(high.y), float_above(high.z)};
}

void check_finite(const pack::BatchInstance& record, const std::string& where) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float value : {record.bounds_min_ws[axis], record.bounds_max_ws[axis]}) {
      if (!std::isfinite(value)) {
        fail(where, std::string("has a coordinate in the world that is too large for a float (") + "xyz"[axis] + " " +
                        to_text(value) + ")");
      }
    }
  }
}

/// A node takes few bytes in a file, but each batch of its mesh becomes a record. So the records are counted before
/// memory is allocated.
size_t count_batch_instances(const Scene& scene, const std::vector<MeshRecords>& meshes, const pack::Contents& pack) {
  constexpr uint64_t most_batches = 1ull << 28;
  uint64_t count = 0;
  for (const MeshInstance& instance : scene.instances) {
    const uint32_t mesh = record_of(instance, meshes);
    if (mesh != no_index) count += pack.meshes[mesh].batch_count;
    if (count > most_batches) {
      fail(instance.where, "the instances up to here have more than " + std::to_string(most_batches) + " batches (" +
                               std::to_string(count) + ")");
    }
  }
  return count;
}

/// Sorting key: opaque before masked, then material; the rest only for a fixed order.
auto draw_order(const pack::Contents& pack, const pack::BatchInstance& record) {
  const uint32_t material = pack.batches[record.batch].material;
  return std::tuple(pack.materials[material].alpha_mode, material, record.instance, record.batch);
}

}  // namespace

void make_instances(const Scene& scene, const std::vector<MeshRecords>& meshes, Strings& strings,
                    pack::Contents& pack) {
  pack.batch_instances.reserve(count_batch_instances(scene, meshes, pack));
  std::vector<const MeshInstance*> sources;
  for (const MeshInstance& instance : scene.instances) {
    const uint32_t mesh = record_of(instance, meshes);
    if (mesh == no_index) continue;
    const uint32_t number = fit_u32(pack.instances.size(), "instances");
    pack.instances.push_back(instance_record(instance, mesh, strings));
    sources.push_back(&instance);
    for (uint32_t b = 0; b < pack.meshes[mesh].batch_count; ++b) {
      pack.batch_instances.push_back({.batch = pack.meshes[mesh].first_batch + b, .instance = number});
    }
  }
  tbb::parallel_for(size_t{0}, pack.batch_instances.size(),
                    [&](size_t i) { set_bounds(pack, pack.batch_instances[i]); });
  for (const pack::BatchInstance& record : pack.batch_instances) {
    check_finite(record, sources[record.instance]->where);
  }
  std::sort(pack.batch_instances.begin(), pack.batch_instances.end(),
            [&](const auto& a, const auto& b) { return draw_order(pack, a) < draw_order(pack, b); });
}

}  // namespace chandelier::baker
