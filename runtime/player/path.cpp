// SPDX-License-Identifier: Apache-2.0
#include "player/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "player/camera.h"
#include "player/darkness.h"
#include "player/image_files.h"
#include "player/stats.h"

namespace chandelier::player {
namespace {

using Json = nlohmann::ordered_json;

Json parse_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file))
    throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  try {
    return Json::parse(stream);
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(fmt::format("{}: not JSON (byte {})", file.string(), error.byte));
  }
}

std::vector<Camera> read_keys(const std::filesystem::path& file, const glm::dvec3& origin_m) {
  const Json json = parse_file(file);
  if (!json.is_object() || !json.contains("keys") || !json["keys"].is_array())
    throw std::runtime_error(fmt::format("{}: must be an object with an array of cameras, \"keys\"", file.string()));
  std::vector<Camera> keys;
  for (const Json& key : json["keys"]) {
    const auto camera = key.is_string() ? camera_from_numbers(key.get<std::string>()) : std::nullopt;
    if (!camera)
      throw std::runtime_error(fmt::format("{}: keys: {}: must be \"ex,ey,ez,tx,ty,tz,fov_deg\" ({})", file.string(),
                                           keys.size(), key.dump()));
    keys.push_back(in_world(*camera, origin_m));
  }
  if (keys.size() < 2)
    throw std::runtime_error(
        fmt::format("{}: keys: a path needs two cameras or more ({})", file.string(), keys.size()));
  return keys;
}

double rmse_shown(const Picture& a, const Picture& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.shown.size(); ++i) sum += std::pow((a.shown[i] - b.shown[i]) / 255.0, 2);
  return std::sqrt(sum / (0.75 * static_cast<double>(a.shown.size())));  // alpha is the same everywhere
}

// The same view with every light held at its centre of the frame before, if it had one.
Picture without_changes(Renderer& renderer, RenderSettings settings, std::span<const uint32_t> centers_before) {
  settings.centers.assign(centers_before.begin(), centers_before.end());
  renderer.draw(settings);
  return renderer.read_back();
}

double mean(const std::vector<PathStep>& steps, auto value) {
  double sum = 0.0;
  for (size_t i = 1; i < steps.size(); ++i) sum += static_cast<double>(value(steps[i]));
  return sum / static_cast<double>(steps.size() - 1);
}

Json path_json(const Options& options, const Run& run, const std::vector<PathStep>& steps) {
  Json frames = Json::array();
  for (const PathStep& step : steps)
    frames.push_back({{"shadow_maps", step.shadow_maps},
                      {"lights_in_view", step.lights_in_view},
                      {"lights_kept_in_view", step.lights_kept_in_view},
                      {"lights_changed", step.lights_changed},
                      {"unexplained_rmse", step.unexplained_rmse}});
  return {{"path", options.path.filename().string()},
          {"last_frame", to_json(run)},
          {"mean",
           {{"shadow_maps", mean(steps, [](const PathStep& s) { return s.shadow_maps; })},
            {"lights_changed", mean(steps, [](const PathStep& s) { return s.lights_changed; })},
            {"unexplained_rmse", mean(steps, [](const PathStep& s) { return s.unexplained_rmse; })}}},
          {"frames", std::move(frames)}};
}

}  // namespace

std::vector<Camera> cameras_along(const std::vector<Camera>& keys, uint32_t frames) {
  std::vector<Camera> cameras;
  for (uint32_t i = 0; i < frames; ++i) {
    const float at = frames < 2
                         ? 0.0f
                         : static_cast<float>(i) * static_cast<float>(keys.size() - 1) / static_cast<float>(frames - 1);
    const size_t key = std::min(static_cast<size_t>(at), keys.size() - 2);
    const float part = at - static_cast<float>(key);
    const Camera& a = keys[key];
    const Camera& b = keys[key + 1];
    const glm::vec3 eye = glm::mix(a.eye_ws, b.eye_ws, part);
    const glm::vec3 forward = glm::mix(a.forward_ws, b.forward_ws, part);
    // Halfway between opposite directions there is none: stay with the nearer key.
    const glm::vec3 towards = glm::dot(forward, forward) > 1e-6f ? forward : (part < 0.5f ? a : b).forward_ws;
    // Computed at the origin: far away, a target one metre ahead would be rounded.
    cameras.push_back(camera_looking_at({}, glm::normalize(towards), glm::mix(a.yfov_rad, b.yfov_rad, part)));
    cameras.back().eye_ws = eye;
  }
  return cameras;
}

std::vector<Camera> read_path(const std::filesystem::path& file, uint32_t frames, const glm::dvec3& origin_m) {
  return cameras_along(read_keys(file, origin_m), frames);
}

CenterChanges center_changes(std::span<const uint32_t> before, std::span<const uint32_t> after) {
  CenterChanges changes;
  for (size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    if (before[i] == pack::none || after[i] == pack::none) continue;
    ++changes.kept_in_view;
    changes.changed += before[i] != after[i];
  }
  return changes;
}

void run_path(const Options& options, const pack::File& pack, const gpu::Device& device, Renderer& renderer,
              const VisibilitySource& visibility) {
  const glm::dvec3& origin_m = pack.view().bake_info->origin_m;
  const std::vector<Camera> cameras = read_path(options.path, options.frames.value_or(60), origin_m);
  make_folder(options.report);
  Run run{.pack = options.pack.filename().string(),
          .device = device.name,
          .driver = device.driver,
          .preset = options.recipes.front().preset,
          .frames = 1,
          .image = "last.png"};
  std::vector<PathStep> steps;
  std::vector<uint32_t> before;
  std::optional<float> exposure_ev = options.exposure_ev;
  for (const Camera& camera : cameras) {
    run.camera = {"", camera, origin_m};
    run.settings = render_settings(options, options.recipes.front().recipe, camera, visibility);
    run.settings.exposure_ev = exposure_ev;
    run.settings.previous_centers = before;
    run.stats = renderer.draw(run.settings);
    if (!exposure_ev) exposure_ev = run.stats.exposure_ev;  // or brightness would follow the view
    const CenterChanges changes = center_changes(before, run.stats.centers);
    PathStep step{run.stats.shadow_maps, run.stats.lights_in_view, changes.kept_in_view, changes.changed, 0.0};
    const bool is_last = steps.size() + 1 == cameras.size();
    if (changes.changed > 0 || is_last) {
      const Picture picture = renderer.read_back();
      if (is_last) {
        write_picture(options.report / run.image, picture);
        warn_of_black(options, pack.view(), picture);
      }
      if (changes.changed > 0)
        step.unexplained_rmse = rmse_shown(picture, without_changes(renderer, run.settings, before));
    }
    steps.push_back(step);
    before = run.stats.centers;
  }
  const Json json = path_json(options, run, steps);
  write_file(options.report / "path.json", json.dump(2) + "\n");
  fmt::print(stderr,
             "{}: {} frames; per frame {:.1f} shadow maps, {:.2f} lights that change their map, RMSE {:.5f} from these "
             "changes\n",
             (options.report / "path.json").string(), steps.size(), json["mean"]["shadow_maps"].get<double>(),
             json["mean"]["lights_changed"].get<double>(), json["mean"]["unexplained_rmse"].get<double>());
}

}  // namespace chandelier::player
