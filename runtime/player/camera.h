// SPDX-License-Identifier: Apache-2.0
// Cameras: of a pack, from numbers, or a view of everything; and flying.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "frame/renderer.h"

namespace chandelier::player {

/// How a camera was chosen: asked for, or by the program for a pack without cameras, and then which view.
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

/// True if `text` looks like numbers, "1,2,3,…", not like a name.
bool is_camera_numbers(std::string_view text);
/// "ex,ey,ez,tx,ty,tz,fov_deg": eye and target in metres, whole vertical angle in degrees. Empty if it is malformed.
std::optional<FileCamera> camera_from_numbers(std::string_view text);
/// The inverse: a camera as text for --camera.
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
