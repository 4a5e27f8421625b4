// SPDX-License-Identifier: Apache-2.0
#include "player/scene.h"

#include <fmt/format.h>

#include <cstdio>

#include "player/budget.h"
#include "player/darkness.h"

namespace chandelier::player {
namespace {

constexpr int64_t ns_per_s = 1'000'000'000;

NamedCamera camera_of(const Options& options, const pack::File& pack) {
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  if (options.mode == Mode::path) return {};  // which has cameras of its own
  const glm::dvec3& origin_m = pack.view().bake_info->origin_m;
  if (options.camera) return {"", in_world(*options.camera, origin_m), origin_m};
  const NamedCamera camera = choose_camera(pack, options.camera_name, aspect);
  if (camera.chosen == ChosenView::inside || camera.chosen == ChosenView::without_sky)
    fmt::print(stderr, "{}: has no camera: chosen {}, a view of something lit, which is --camera {}\n",
               options.pack.string(), name_of(camera.chosen), camera_numbers(pack.view(), camera.camera));
  return camera;
}

Options with_headlight(Options options, const pack::View& pack) {
  if (!options.headlight) options.headlight = automatic_headlight(options, pack);
  return options;
}

}  // namespace

FileStamp stamp_of(const std::filesystem::path& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) return {};
  return {.device = status.st_dev,
          .inode = status.st_ino,
          .size_bytes = status.st_size,
          .changed_ns = int64_t{status.st_mtim.tv_sec} * ns_per_s + status.st_mtim.tv_nsec};
}

Scene::Scene(const Options& asked)
    : stamp(stamp_of(asked.pack)),
      pack(asked.pack, 0, pack::Hold::copied),
      world(pack),
      options(with_headlight(asked, pack.view())),
      camera(camera_of(asked, pack)) {
  warn_of_no_lights(asked, options, pack.view());
  if (options.mode != Mode::compare) apply_budget(options, camera, pack, world);
}

}  // namespace chandelier::player
