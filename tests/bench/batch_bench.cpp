// SPDX-License-Identifier: Apache-2.0
// Compares ways to divide triangles into batches: chandelier-batch-bench SCENE.gltf…
// Per way: the SAH cost (half-area · triangles of each batch in the world, summed, over the scene's half-area), the
// triangles in batches that a sphere of 3 m touches, triangles per batch, and how fast.
#include <fmt/core.h>
#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <numeric>
#include <random>

#include "bake/batch_split.h"
#include "bake/clean.h"
#include "bake/quantize.h"
#include "bake/shells.h"
#include "bake/weld.h"
#include "import/import.h"

namespace chandelier::baker {
namespace {

constexpr size_t most_triangles = 100, meshlet_vertices = 255;

/// Corners of all triangles, batch after batch.
struct Batches {
  std::vector<uint32_t> indices;
  std::vector<uint32_t> counts;
};

std::vector<BvhItem> boxes_of(const PackedPrimitive& primitive, int closed) {
  std::vector<BvhItem> boxes;
  for (size_t t = 0; t < primitive.triangle_count(); ++t) {
    if (closed >= 0 && primitive.closed[t] != (closed == 1)) continue;
    boxes.push_back(triangle_box(corner_of(primitive, t, 0), corner_of(primitive, t, 1), corner_of(primitive, t, 2),
                                 static_cast<uint32_t>(t)));
  }
  return boxes;
}

void append(const PackedPrimitive& primitive, const BatchOrder& order, Batches& out) {
  for (const uint32_t t : order.triangles) {
    out.indices.insert(out.indices.end(), &primitive.indices[3 * t], &primitive.indices[3 * t] + 3);
  }
  out.counts.insert(out.counts.end(), order.counts.begin(), order.counts.end());
}

Batches by_sah(const PackedPrimitive& primitive) {
  Batches out;
  append(primitive, split_into_batches(boxes_of(primitive, -1), most_triangles), out);
  return out;
}

Batches by_sah_closed_apart(const PackedPrimitive& primitive) {
  Batches out;
  for (const int closed : {1, 0})
    append(primitive, split_into_batches(boxes_of(primitive, closed), most_triangles), out);
  return out;
}

Batches by_index(const PackedPrimitive& primitive) {
  Batches out{primitive.indices, {}};
  for (size_t left = primitive.triangle_count(); left > 0; left -= out.counts.back()) {
    out.counts.push_back(static_cast<uint32_t>(std::min(left, most_triangles)));
  }
  return out;
}

template <typename Build>
Batches by_meshlets(const PackedPrimitive& primitive, Build build) {
  const size_t bound = meshopt_buildMeshletsBound(primitive.indices.size(), meshlet_vertices, most_triangles);
  std::vector<meshopt_Meshlet> meshlets(bound);
  std::vector<uint32_t> vertices(bound * meshlet_vertices);
  std::vector<uint8_t> corners(bound * most_triangles * 3);
  meshlets.resize(build(meshlets.data(), vertices.data(), corners.data()));
  Batches out;
  for (const meshopt_Meshlet& meshlet : meshlets) {
    for (size_t i = 0; i < size_t{meshlet.triangle_count} * 3; ++i) {
      out.indices.push_back(vertices[meshlet.vertex_offset + corners[meshlet.triangle_offset + i]]);
    }
    out.counts.push_back(meshlet.triangle_count);
  }
  return out;
}

Batches by_buildMeshlets(const PackedPrimitive& primitive) {
  std::vector<uint32_t> order(primitive.indices.size());
  meshopt_optimizeVertexCache(order.data(), primitive.indices.data(), order.size(), primitive.vertices.size());
  return by_meshlets(primitive, [&](auto* meshlets, auto* vertices, auto* corners) {
    return meshopt_buildMeshlets(meshlets, vertices, corners, order.data(), order.size(),
                                 &primitive.vertices[0].position_ls.x, primitive.vertices.size(), sizeof(PackedVertex),
                                 meshlet_vertices, most_triangles, 0.0f);
  });
}

Batches by_spatialSort(const PackedPrimitive& primitive) {
  std::vector<uint32_t> order(primitive.indices.size());
  meshopt_spatialSortTriangles(order.data(), primitive.indices.data(), order.size(),
                               &primitive.vertices[0].position_ls.x, primitive.vertices.size(), sizeof(PackedVertex));
  return by_meshlets(primitive, [&](auto* meshlets, auto* vertices, auto* corners) {
    return meshopt_buildMeshletsScan(meshlets, vertices, corners, order.data(), order.size(), primitive.vertices.size(),
                                     meshlet_vertices, most_triangles);
  });
}

struct WorldBatch {
  glm::vec3 low{INFINITY}, high{-INFINITY};
  double triangles = 0;

  double half_area() const {
    const glm::dvec3 d = glm::dvec3(high) - glm::dvec3(low);
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

void place(const PackedPrimitive& primitive, const Batches& batches, const glm::dmat4& world_from_local,
           std::vector<WorldBatch>& out) {
  size_t next = 0;
  for (const uint32_t count : batches.counts) {
    WorldBatch batch;
    batch.triangles = count;
    for (size_t i = 0; i < 3 * size_t{count}; ++i, ++next) {
      const glm::vec3 p(world_from_local * glm::dvec4(primitive.vertices[batches.indices[next]].position_ls, 1));
      batch.low = glm::min(batch.low, p);
      batch.high = glm::max(batch.high, p);
    }
    out.push_back(batch);
  }
}

/// Mean number of triangles in batches that a sphere of 3 m touches, over 500 spheres in the scene's box.
double touched(const std::vector<WorldBatch>& batches, const WorldBatch& all) {
  std::mt19937 random(1);
  double sum = 0;
  for (int s = 0; s < 500; ++s) {
    glm::vec3 center;
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = all.low[axis] + (all.high[axis] - all.low[axis]) *
                                         static_cast<float>(static_cast<double>(random()) / 4294967296.0);
    }
    for (const WorldBatch& batch : batches) {
      const glm::vec3 nearest = glm::clamp(center, batch.low, batch.high);
      if (glm::distance(nearest, center) <= 3) sum += batch.triangles;
    }
  }
  return sum / 500;
}

struct Way {
  const char* name;
  Batches (*cut)(const PackedPrimitive&);
};

void compare(const Scene& scene, const std::vector<PackedMesh>& meshes, const Way& way) {
  std::vector<const PackedPrimitive*> primitives;
  for (const PackedMesh& mesh : meshes) {
    for (const PackedPrimitive& primitive : mesh.primitives) {
      if (primitive.triangle_count() > 0) primitives.push_back(&primitive);
    }
  }
  std::vector<Batches> cuts(primitives.size());
  double seconds = INFINITY;
  for (int round = 0; round < 3; ++round) {
    const auto start = std::chrono::steady_clock::now();
    tbb::parallel_for(size_t{0}, cuts.size(), [&](size_t i) { cuts[i] = way.cut(*primitives[i]); });
    seconds = std::min(seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::vector<WorldBatch> batches;
  for (const MeshInstance& instance : scene.instances) {
    for (const PackedPrimitive& primitive : meshes[instance.mesh].primitives) {
      if (primitive.triangle_count() == 0) continue;
      const auto number = std::find(primitives.begin(), primitives.end(), &primitive) - primitives.begin();
      place(primitive, cuts[static_cast<size_t>(number)], instance.world_from_local, batches);
    }
  }
  WorldBatch all;
  double cost = 0, unique = 0, unique_batches = 0;
  for (const WorldBatch& batch : batches) {
    all.low = glm::min(all.low, batch.low);
    all.high = glm::max(all.high, batch.high);
    cost += batch.half_area() * batch.triangles;
  }
  for (const Batches& cut : cuts) {
    unique += static_cast<double>(cut.indices.size() / 3);
    unique_batches += static_cast<double>(cut.counts.size());
  }
  fmt::print("  {:<28} {:>10.1f} {:>10.0f} {:>10.1f} {:>10.0f} {:>8.2f}\n", way.name, cost / all.half_area(),
             touched(batches, all), unique / unique_batches, unique_batches, unique / seconds / 1e6);
}

void bench(const char* path) {
  Scene scene;
  Warnings warnings;
  import_gltf(path, scene, warnings);
  pack::BakeInfo info;
  std::vector<PackedMesh> meshes = quantize(scene, {}, info);
  for (PackedMesh& mesh : meshes) {
    for (PackedPrimitive& primitive : mesh.primitives) weld(primitive);
    clean(mesh, scene.materials, true);
    find_shells(mesh, scene.materials, true);
  }
  fmt::print("{}\n  {:<28} {:>10} {:>10} {:>10} {:>10} {:>8}\n", path, "way", "SAH cost", "3 m sphere", "triangles",
             "batches", "Mtri/s");
  for (const Way& way : {Way{"index order", by_index}, Way{"meshopt buildMeshlets", by_buildMeshlets},
                         Way{"meshopt spatialSort + scan", by_spatialSort}, Way{"binned SAH", by_sah},
                         Way{"binned SAH, closed apart", by_sah_closed_apart}}) {
    compare(scene, meshes, way);
  }
}

}  // namespace
}  // namespace chandelier::baker

int main(int argc, char** argv) {
  try {
    if (argc < 2) fmt::print("chandelier-batch-bench SCENE.gltf…: compares ways to divide triangles into batches\n");
    for (int i = 1; i < argc; ++i) chandelier::baker::bench(argv[i]);
    return argc < 2 ? 2 : 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "chandelier-batch-bench: error: {}\n", error.what());
    return 1;
  }
}
