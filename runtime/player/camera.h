// SPDX-License-Identifier: Apache-2.0
// Where a picture is taken from: a pack's camera, numbers, or a view of everything; and how one flies.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "frame/renderer.h"

namespace chandelier::player {

/// Who chose a camera: someone, or the program for a pack that has none, and then what of it.
enum class ChosenView { asked, whole, without_sky, inside };

std::string_view name_of(ChosenView chosen);

struct NamedCamera {
  std::string name;
  Camera camera;
  glm::dvec3 origin_m{0.0};  // of the pack: its world in the file's coordinates
  ChosenView chosen = ChosenView::asked;
};

/// A camera in the coordinates of the glTF, from which a pack's world may lie far away.
struct FileCamera {
  glm::dvec3 eye_m{0.0};
  Camera camera;  // but for its eye_ws
};
/// In the world of a pack with this origin.
Camera in_world(const FileCamera& camera, const glm::dvec3& origin_m);
FileCamera in_file(const Camera& camera, const glm::dvec3& origin_m);

/// True where `text` is meant as numbers rather than as a name: "1,2,3,…".
bool is_camera_numbers(std::string_view text);
/// "ex,ey,ez,tx,ty,tz,fov_deg": eye and target in metres, whole vertical angle in degrees. Nothing where it is
/// malformed.
std::optional<FileCamera> camera_from_numbers(std::string_view text);
/// The same of a camera, for somebody to type.
std::string camera_numbers(const pack::View& pack, const Camera& camera);
/// Upright (+Y) unless it looks straight up or down.
Camera camera_looking_at(const glm::vec3& eye_ws, const glm::vec3& target_ws, float yfov_rad);
/// Sees the whole box from a corner above.
Camera camera_framing(const glm::vec3& bounds_min_ws, const glm::vec3& bounds_max_ws, float aspect);
/// The pack's camera `name`; where that is empty its first, or default_view(). Throws std::runtime_error, one line
/// listing the names there are.
NamedCamera choose_camera(const pack::File& pack, const std::string& name, float aspect);

/// Yaw to the right about +Y, then pitch upwards; stays upright and short of the poles.
void turn(Camera& camera, float yaw_rad, float pitch_rad);
/// Metres to the right, up (world) and forward.
void move(Camera& camera, const glm::vec3& right_up_forward_m);

}  // namespace chandelier::player
