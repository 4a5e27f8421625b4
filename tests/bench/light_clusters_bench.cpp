// SPDX-License-Identifier: Apache-2.0
// How long the selection of light clusters takes over the number of lights (LightCluster, Figure 4).
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <limits>
#include <random>
#include <vector>

#include "brute_force_selection.h"
#include "lights/light_clusters.h"

namespace {

using chandelier::lights::ClusterLight;
using chandelier::lights::ClusterSettings;

// Lights of range 3 to 10 m, as dense as the paper's atrium however many they are: one in 24 square metres of floor, 5
// m high.
std::vector<ClusterLight> random_lights(int64_t count) {
  std::mt19937 random(7);
  const float half_side_m = std::sqrt(24.0f * float(count)) / 2.0f;
  std::uniform_real_distribution<float> along(-half_side_m, half_side_m), up(0.0f, 5.0f), range(3.0f, 10.0f);
  std::vector<ClusterLight> lights(static_cast<size_t>(count));
  for (ClusterLight& light : lights) {
    light.position_ws = {along(random), up(random), along(random)};
    light.range_m = range(random);
  }
  return lights;
}

// The process's own time: what others run beside it does not count.
double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void select_light_clusters(benchmark::State& state) {
  const std::vector<ClusterLight> lights = random_lights(state.range(0));
  ClusterSettings settings;
  settings.camera_ws = {0.0f, 1.7f, 0.0f};
  settings.d_init_m = float(state.range(1)) / 10.0f;
  size_t clusters = 0;
  double least_ms = std::numeric_limits<double>::infinity();
  for (auto iteration : state) {
    const double start_ms = cpu_ms();
    clusters = chandelier::lights::select_light_clusters(lights, settings).clusters.size();
    least_ms = std::min(least_ms, cpu_ms() - start_ms);
    benchmark::DoNotOptimize(clusters);
  }
  state.counters["light_clusters"] = double(clusters);
  state.counters["least_cpu_ms"] = least_ms;
  state.SetComplexityN(state.range(0));
  if (lights.size() > 8192) return;  // brute force takes minutes
  const double start_ms = cpu_ms();
  benchmark::DoNotOptimize(chandelier::lights::brute_force_clusters(lights, settings).clusters.size());
  state.counters["brute_force_over_this"] = (cpu_ms() - start_ms) / least_ms;
}

BENCHMARK(select_light_clusters)
    ->ArgNames({"lights", "d_init_dm"})
    ->ArgsProduct({{32, 128, 512, 2048, 8192, 32768, 100000}, {5, 16, 50}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
