// SPDX-License-Identifier: Apache-2.0
#include "player/scene.h"

#include "player/budget.h"

namespace chandelier::player {
namespace {

constexpr int64_t ns_per_s = 1'000'000'000;

NamedCamera camera_of(const Options& options, const pack::File& pack) {
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const glm::dvec3& origin_m = pack.view().bake_info->origin_m;
  return options.camera ? NamedCamera{"", in_world(*options.camera, origin_m), origin_m}
                        : choose_camera(pack, options.camera_name, aspect);
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
    : options(asked),
      stamp(stamp_of(asked.pack)),
      pack(asked.pack, 0, asked.mode == Mode::window ? pack::Hold::copied : pack::Hold::mapped),
      camera(camera_of(asked, pack)) {
  if (options.mode != Mode::compare) apply_budget(options, camera, pack);
}

}  // namespace chandelier::player
