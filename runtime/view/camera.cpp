// SPDX-License-Identifier: Apache-2.0
#include "view/camera.h"

#include <cmath>

namespace chandelier {

CameraAxes axes_of(const Camera& camera) {
  CameraAxes axes;
  axes.forward = glm::normalize(camera.forward_ws);
  glm::vec3 right = glm::cross(axes.forward, camera.up_ws);
  if (glm::dot(right, right) < 1e-8f)
    right = glm::cross(axes.forward, std::abs(axes.forward.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1));
  axes.right = glm::normalize(right);
  axes.up = glm::cross(axes.right, axes.forward);
  return axes;
}

glm::mat4 clip_from_eye(const Camera& camera, float aspect) {
  const CameraAxes a = axes_of(camera);
  const float focal = 1.0f / std::tan(camera.yfov_rad * 0.5f);
  const glm::mat4 view_from_eye = glm::transpose(
      glm::mat4(glm::vec4(a.right, 0), glm::vec4(a.up, 0), glm::vec4(-a.forward, 0), glm::vec4(0, 0, 0, 1)));
  const glm::mat4 clip_from_view(glm::vec4(focal / aspect, 0, 0, 0), glm::vec4(0, -focal, 0, 0), glm::vec4(0, 0, 0, -1),
                                 glm::vec4(0, 0, camera.znear_m, 0));
  return clip_from_view * view_from_eye;
}

FrustumPlanes frustum_planes(const Camera& camera, float aspect) {
  const CameraAxes a = axes_of(camera);
  const float y = std::tan(camera.yfov_rad * 0.5f);
  const float x = y * aspect;
  const auto plane = [&](glm::vec3 normal, float offset) {
    normal = glm::normalize(normal);
    return glm::vec4(normal, -glm::dot(normal, camera.eye_ws) - offset);
  };
  return {plane(a.right + a.forward * x, 0), plane(-a.right + a.forward * x, 0), plane(a.up + a.forward * y, 0),
          plane(-a.up + a.forward * y, 0), plane(a.forward, camera.znear_m)};
}

bool intersects(const FrustumPlanes& planes, const glm::vec3& center_ws, float radius_m) {
  for (const glm::vec4& plane : planes)
    if (glm::dot(glm::vec3(plane), center_ws) + plane.w < -radius_m) return false;
  return true;
}

}  // namespace chandelier
