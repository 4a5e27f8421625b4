// SPDX-License-Identifier: Apache-2.0
// Cameras of the player.
#include "player/camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "player/default_view.h"

namespace chandelier::player {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr double fine_m = 1024.0;        // floats up to half of it are at most 0.03 mm apart
constexpr float highest_pitch = 1.553f;  // radians: 89 degrees
const glm::vec3 up(0.0f, 1.0f, 0.0f);

Camera named(const pack::Camera& from) {
  Camera camera;
  camera.eye_ws = from.position_ws;
  camera.forward_ws = from.forward_ws;
  camera.up_ws = from.up_ws;
  camera.yfov_rad = from.yfov_rad;
  if (from.znear_m > 0.0f) camera.znear_m = from.znear_m;
  return camera;
}

}  // namespace

std::string_view name_of(ChosenView chosen) {
  switch (chosen) {
    case ChosenView::whole:
      return "whole scene";
    case ChosenView::without_sky:
      return "without sky";
    case ChosenView::inside:
      return "inside";
    default:
      return "asked";
  }
}

bool is_camera_numbers(std::string_view text) {
  return text.find(',') != text.npos && text.find_first_not_of("0123456789+-.eE, ") == text.npos;
}

Camera in_world(const FileCamera& camera, const glm::dvec3& origin_m) {
  Camera out = camera.camera;
  out.eye_ws = glm::vec3(camera.eye_m - origin_m);
  return out;
}

FileCamera in_file(const Camera& camera, const glm::dvec3& origin_m) {
  return {origin_m + glm::dvec3(camera.eye_ws), camera};
}

std::optional<FileCamera> camera_from_numbers(std::string_view text) {
  std::array<double, 7> numbers{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return std::nullopt;
    while (at != end && (*at == ' ' || *at == '+')) ++at;
    const auto [after, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc() || !std::isfinite(numbers[i])) return std::nullopt;
    at = after;
  }
  const glm::dvec3 eye_m(numbers[0], numbers[1], numbers[2]);
  const glm::dvec3 from_m = glm::round(eye_m / fine_m) * fine_m;  // relative to it, floats are precise
  const glm::vec3 eye(eye_m - from_m), target(glm::dvec3(numbers[3], numbers[4], numbers[5]) - from_m);
  const float distance = glm::distance(eye, target);
  const auto fov_deg = static_cast<float>(numbers[6]);
  if (at != end || !std::isfinite(glm::length(glm::vec3(eye_m))) || !(distance > 1e-6f) ||
      !std::isfinite(distance * distance) || !(fov_deg > 0.0f && fov_deg < 179.0f))
    return std::nullopt;
  return FileCamera{eye_m, camera_looking_at(eye, target, fov_deg * pi / 180.0f)};
}

std::string camera_numbers(const pack::View& pack, const Camera& camera) {
  // As precise as floats are in the pack's world, wherever that lies in the file's coordinates.
  const glm::vec3 far = glm::abs(camera.eye_ws);
  const double size = std::max({double{far.x}, double{far.y}, double{far.z}, 1.0});
  const double finest = std::pow(10.0, std::floor(std::log10(size)) - 5.0);
  const auto rounded = [finest](double value) { return std::round(value / finest) * finest; };
  const glm::dvec3 eye = pack.bake_info->origin_m + glm::dvec3(camera.eye_ws);
  // So far ahead that rounding turns the view by no more than a hundredth of a degree.
  const glm::dvec3 target = eye + glm::dvec3(camera.forward_ws) * std::max(1.0, 1e4 * finest);
  return fmt::format("{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.4g}", rounded(eye.x), rounded(eye.y),
                     rounded(eye.z), rounded(target.x), rounded(target.y), rounded(target.z),
                     camera.yfov_rad * 180.0f / pi);
}

Camera camera_looking_at(const glm::vec3& eye_ws, const glm::vec3& target_ws, float yfov_rad) {
  Camera camera;
  camera.eye_ws = eye_ws;
  camera.forward_ws = glm::normalize(target_ws - eye_ws);
  camera.yfov_rad = yfov_rad;
  const bool vertical = std::abs(camera.forward_ws.y) > 0.9999f;
  const glm::vec3 about_up = vertical ? glm::vec3(0.0f, 0.0f, -1.0f) : up;
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward_ws, about_up));
  camera.up_ws = glm::cross(right, camera.forward_ws);
  return camera;
}

Camera camera_framing(const glm::vec3& bounds_min_ws, const glm::vec3& bounds_max_ws, float aspect) {
  const glm::vec3 center = 0.5f * (bounds_min_ws + bounds_max_ws);
  const float radius = std::max(0.5f * glm::length(bounds_max_ws - bounds_min_ws), 1e-3f);
  const float yfov = 50.0f * pi / 180.0f;
  // The box's sphere must fit the narrower of the two angles.
  const float half_angle = std::min(0.5f * yfov, std::atan(std::tan(0.5f * yfov) * aspect));
  const float distance = radius / std::sin(half_angle);
  const glm::vec3 from = glm::normalize(glm::vec3(0.6f, 0.45f, 1.0f));
  Camera camera = camera_looking_at(center + distance * from, center, yfov);
  camera.znear_m = std::min(camera.znear_m, 0.5f * (distance - radius));
  return camera;
}

NamedCamera choose_camera(const pack::File& pack, const std::string& name, float aspect) {
  const auto cameras = pack.view().cameras;
  const glm::dvec3& origin_m = pack.view().bake_info->origin_m;
  std::vector<std::string_view> names;
  for (const pack::Camera& camera : cameras) {
    names.push_back(pack.text(camera.name));
    if (name.empty() || names.back() == name) return {std::string(names.back()), named(camera), origin_m};
  }
  if (name.empty()) return default_view(pack.view(), aspect);
  if (names.empty()) throw std::runtime_error(fmt::format("--camera: the pack has no cameras ({})", name));
  throw std::runtime_error(
      fmt::format("--camera: the pack has {}, none of that name ({})", fmt::join(names, ", "), name));
}

void turn(Camera& camera, float yaw_rad, float pitch_rad) {
  const glm::vec3& f = camera.forward_ws;
  const float yaw = std::atan2(f.x, -f.z) + yaw_rad;
  const float pitch = std::clamp(std::asin(std::clamp(f.y, -1.0f, 1.0f)) + pitch_rad, -highest_pitch, highest_pitch);
  const glm::vec3 forward(std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch));
  const Camera upright = camera_looking_at(glm::vec3(0.0f), forward, camera.yfov_rad);
  camera.forward_ws = upright.forward_ws;
  camera.up_ws = upright.up_ws;
}

void move(Camera& camera, const glm::vec3& right_up_forward_m) {
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward_ws, camera.up_ws));
  camera.eye_ws += right_up_forward_m.x * right + right_up_forward_m.y * up + right_up_forward_m.z * camera.forward_ws;
}

}  // namespace chandelier::player
