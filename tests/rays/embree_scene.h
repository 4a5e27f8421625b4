// SPDX-License-Identifier: Apache-2.0
// Rays that Embree traces through a row of triangles.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace chandelier::test {

using WorldTriangle = std::array<glm::vec3, 3>;

class EmbreeScene {
 public:
  explicit EmbreeScene(std::span<const WorldTriangle> triangles)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), triangles.size() * 3));
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size()));
    for (size_t i = 0; i < triangles.size() * 3; ++i) {
      corners[i] = triangles[i / 3][i % 3];
      indices[i] = static_cast<uint32_t>(i);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Is there anything at from + t · (to - from), t from `gap` to 1 - `gap`?
  bool blocked(const glm::vec3& from, const glm::vec3& to, float gap = 0.0f) const {
    RTCRay ray = ray_along(from, to - from, gap, 1.0f - gap);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0.0f;
  }

  struct First {
    float t;  // along `way`; infinite where there is nothing
    uint32_t triangle;
  };
  First first(const glm::vec3& from, const glm::vec3& way) const {
    RTCRayHit ray{ray_along(from, way, 0.0f, INFINITY), {}};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    return {ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : ray.ray.tfar, ray.hit.primID};
  }

 private:
  static RTCRay ray_along(const glm::vec3& from, const glm::vec3& d, float near, float far) {
    return {from.x, from.y, from.z, near, d.x, d.y, d.z, 0.0f, far, ~0u, 0, 0};
  }

  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace chandelier::test
