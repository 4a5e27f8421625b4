// SPDX-License-Identifier: Apache-2.0
// How fast a pack of a gibibyte opens: mapped, hashed and every value checked, from the page cache.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "image_format.h"
#include "octahedral.h"
#include "pack_checks.h"
#include "pack_file.h"

namespace {

using namespace chandelier::pack;

// A terrain of square fields, each one batch; about the shares that a baked scene has: half geometry, a fifth
// hierarchy, the rest texels.
constexpr uint32_t field_side = 7;  // quads: 98 triangles a batch
constexpr uint32_t field_vertices = (field_side + 1) * (field_side + 1);
constexpr uint32_t field_triangles = 2 * field_side * field_side;

void add_field(Contents& c, float x0, float z0) {
  const auto first_vertex = static_cast<uint32_t>(c.positions.size());
  const auto first_index = static_cast<uint32_t>(c.indices.size());
  for (uint32_t i = 0; i < field_vertices; ++i) {
    const float x = x0 + static_cast<float>(i % (field_side + 1)), z = z0 + static_cast<float>(i / (field_side + 1));
    c.positions.push_back({{x, std::sin(x / 9) + std::cos(z / 7), z}});
    c.vertex_attributes.push_back({encode_normal({0, 1, 0}), encode_tangent({1, 0, 0, 1}), {x, z}, {0, 0}, ~0u});
  }
  for (uint32_t i = 0; i < field_side * field_side; ++i) {
    const uint32_t v = first_vertex + i / field_side * (field_side + 1) + i % field_side;
    const uint32_t down = v + field_side + 1;
    for (const uint32_t corner : {v, down, v + 1, v + 1, down, down + 1}) c.indices.push_back({corner});
  }
  const float side = static_cast<float>(field_side);
  Batch batch;
  batch.bounds_min_ls = {x0, -2, z0};
  batch.bounds_max_ls = {x0 + side, 2, z0 + side};
  batch.first_index = first_index;
  batch.index_count = 3 * field_triangles;
  batch.cone_cutoff = 1;
  const auto number = static_cast<uint32_t>(c.batches.size());
  c.batches.push_back(batch);
  c.batch_instances.push_back({batch.bounds_min_ls, number, batch.bounds_max_ls, 0});
}

/// The hierarchy of items [first, end), depth first, `per_leaf` to a leaf; all boxes alike.
void add_nodes(std::vector<BvhNode>& nodes, uint32_t first, uint32_t end, uint32_t per_leaf, const Mesh& mesh) {
  const size_t at = nodes.size();
  nodes.push_back({mesh.bounds_min_ls, 0, mesh.bounds_max_ls, none});
  if (end - first <= per_leaf) {
    nodes[at].leaf = first * 16 + (end - first);
  } else {
    const uint32_t middle = first + (end - first) / 2;
    add_nodes(nodes, first, middle, per_leaf, mesh);
    add_nodes(nodes, middle, end, per_leaf, mesh);
  }
  nodes[at].skip = static_cast<uint32_t>(nodes.size());
}

void add_hierarchies(Contents& c) {
  Mesh& mesh = c.meshes[0];
  const auto triangles = static_cast<uint32_t>(c.indices.size() / 3);
  const auto batches = static_cast<uint32_t>(c.batches.size());
  add_nodes(c.triangle_bvh, 0, triangles, 4, mesh);
  add_nodes(c.batch_bvh, 0, batches, 4, mesh);
  add_nodes(c.instance_bvh, 0, 1, 4, mesh);
  mesh.node_count = static_cast<uint32_t>(c.triangle_bvh.size());
  for (uint32_t i = 0; i < triangles; ++i) c.triangle_bvh_items.push_back({i});
  for (uint32_t i = 0; i < batches; ++i) c.batch_bvh_items.push_back({i});
  c.instance_bvh_items.push_back({0});
  c.triangle_bvh_areas.resize(c.triangle_bvh.size());
  for (size_t i = c.triangle_bvh.size(); i-- > 0;) {  // children come after their parent
    const BvhNode& node = c.triangle_bvh[i];
    if (node.leaf != none) {
      c.triangle_bvh_areas[i].area_m2 = static_cast<float>(node.leaf % 16) * 0.5f;
    } else {
      c.triangle_bvh_areas[i].area_m2 =
          c.triangle_bvh_areas[i + 1].area_m2 + c.triangle_bvh_areas[c.triangle_bvh[i + 1].skip].area_m2;
    }
  }
}

void add_images(Contents& c, uint32_t count) {
  constexpr uint32_t side = 2048;
  for (uint32_t i = 0; i < count; ++i) {
    Image image{.first_byte = c.image_data.size(),
                .width = side,
                .height = side,
                .level_count = 1,
                .format = ImageFormat::bc5_unorm};
    image.size_bytes = image.stored_bytes = image_bytes(image);
    for (uint64_t at = 0; at < image.size_bytes; ++at) {
      c.image_data.push_back(static_cast<std::byte>(at * 2654435761u >> 13));
    }
    c.images.push_back(image);
  }
}

/// `fields` squared batches and a texel byte for every five others.
Contents terrain(uint32_t fields) {
  Contents c;
  for (uint32_t i = 0; i < fields * fields; ++i) {
    add_field(c, static_cast<float>(i % fields * field_side), static_cast<float>(i / fields * field_side));
  }
  const float side = static_cast<float>(fields * field_side);
  Mesh mesh;
  mesh.bounds_min_ls = c.bake_info.bounds_min_ws = {0, -2, 0};
  mesh.bounds_max_ls = c.bake_info.bounds_max_ws = {side, 2, side};
  mesh.batch_count = static_cast<uint32_t>(c.batches.size());
  mesh.vertex_count = static_cast<uint32_t>(c.positions.size());
  c.meshes.push_back(mesh);
  Instance instance;
  instance.world_from_local = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  c.instances.push_back(instance);
  c.materials.emplace_back();
  add_hierarchies(c);
  add_images(c, 1 + fields * fields / 1500);
  c.bake_info.unique_triangles = c.bake_info.instanced_triangles = c.indices.size() / 3;
  c.bake_info.batch_triangles = field_triangles;
  return c;
}

/// A pack on disk that is deleted at the end; the first time it is opened brings it into the page cache.
struct PackOnDisk {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("chandelier-bench-" + std::to_string(getpid()) + ".pack");
  explicit PackOnDisk(uint32_t fields, Compression compression) {
    const Contents contents = terrain(fields);
    if (const std::string fault = check(view_of(contents)); !fault.empty()) throw Error(fault);
    write(path, contents, compression);
  }
  ~PackOnDisk() { std::filesystem::remove(path); }
};

void open_pack(benchmark::State& state) {
  const bool compressed = state.range(1) != 0;
  const PackOnDisk pack(static_cast<uint32_t>(state.range(0)), compressed ? Compression::smallest : Compression::off);
  uint64_t bytes = 0;
  for (auto iteration : state) {
    const File file(pack.path);
    bytes = 0;
    for (const SectionEntry& entry : file.table()) bytes += entry.count * entry.stride_bytes;
    benchmark::DoNotOptimize(file.view().positions.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes));
  state.counters["opened_MB"] = static_cast<double>(bytes) / 1e6;
  state.counters["stored_MB"] = static_cast<double>(std::filesystem::file_size(pack.path)) / 1e6;
}

// 325 squared batches of 98 triangles make 1 GB.
BENCHMARK(open_pack)
    ->ArgNames({"fields", "compressed"})
    ->Args({325, 0})
    ->Args({100, 0})
    ->Args({100, 1})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
