// SPDX-License-Identifier: Apache-2.0
// Memory and time of an error search among many lights: random lamps over a floor with pillars, as dense however many.
// chandelier-error-bench LIGHTS…
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "../gpu/scene_builder.h"
#include "lights/light_list.h"

namespace {

using namespace chandelier;

test::Scene floor_with(int lights) {
  std::mt19937 random(7);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  test::Scene scene;
  const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.7f)));
  const float half_m = 0.75f * std::sqrt(static_cast<float>(lights));
  scene.add(test::level_square(glm::vec3(0), half_m), white);
  for (int i = 0; i < lights / 4; ++i) {
    const glm::vec3 at(uniform(-half_m, half_m), 0, uniform(-half_m, half_m));
    scene.add(test::box(at, at + glm::vec3(0.4f, uniform(0.5f, 3), 0.4f)), white);
  }
  for (int i = 0; i < lights; ++i) {
    const glm::vec3 at(uniform(-half_m, half_m), uniform(1, 3), uniform(-half_m, half_m));
    scene.lights.push_back(test::point_light(at, uniform(1, 20), uniform(3, 9)));
  }
  return scene;
}

long peak_kib() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

void measure(int lights) {
  const pack::File pack = floor_with(lights).open();
  const World world(pack);
  const float half_m = 0.75f * std::sqrt(static_cast<float>(lights));
  Camera camera;
  camera.eye_ws = {0, 0.9f * half_m, 1.2f * half_m};
  camera.forward_ws = glm::normalize(glm::vec3(0, -0.7f, -1));
  camera.yfov_rad = 1.1f;
  Recipe recipe;
  recipe.select = Select::error_driven;
  recipe.d_init_m = 2.0f;
  Surroundings surroundings(world);
  const long before_kib = peak_kib();
  const auto start = std::chrono::steady_clock::now();
  const LightList list = select_lights(world, recipe, camera, 16.0f / 9.0f, {.surroundings = &surroundings});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{} lights, {} in view: {} maps, {:.1f} s, {} MiB more at its peak\n", lights, list.lights_in_view,
             list.maps.size(), seconds, (peak_kib() - before_kib) / 1024);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) measure(std::atoi(argv[i]));
}
