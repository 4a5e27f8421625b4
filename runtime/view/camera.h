// SPDX-License-Identifier: Apache-2.0
// The camera's matrices and frustum.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace chandelier {

/// World space, metres; looks along `forward` (unit length).
struct Camera {
  glm::vec3 eye_ws{0.0f};
  glm::vec3 forward_ws{0.0f, 0.0f, -1.0f};
  glm::vec3 up_ws{0.0f, 1.0f, 0.0f};
  float yfov_rad = 1.0f;
  float znear_m = 0.05f;

  bool operator==(const Camera&) const = default;
};

/// Right, up and forward, orthonormal. An `up` along `forward` is replaced by another axis.
struct CameraAxes {
  glm::vec3 right;
  glm::vec3 up;
  glm::vec3 forward;
};
CameraAxes axes_of(const Camera& camera);

/// Of positions from the eye, along the world's axes. Reversed depth, 1 at znear and 0 at infinity; clip y points down.
glm::mat4 clip_from_eye(const Camera& camera, float aspect);

/// Sides and near plane; a point is inside where dot(plane.xyz, p) + plane.w >= 0 for all. Normals have unit length.
using FrustumPlanes = std::array<glm::vec4, 5>;
FrustumPlanes frustum_planes(const Camera& camera, float aspect);

/// LightCluster §3.1.2: is any of the sphere inside? Conservative near edges and corners.
bool intersects(const FrustumPlanes& planes, const glm::vec3& center_ws, float radius_m);

}  // namespace chandelier
