// SPDX-License-Identifier: Apache-2.0
// What the camera sees, by a few points of it: what each light adds there, and which lights see them. By rays on the
// CPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "lights/ambient.h"
#include "lights/mean_materials.h"
#include "pack_schema.h"
#include "rays/pack_rays.h"
#include "view/camera.h"
#include "world/world.h"

namespace chandelier {

/// What points are taken from; made once for a pack. The rays must outlive it.
struct SampledScene {
  SampledScene(const pack::View& pack, const rays::PackRays& through, MeanMaterialsOf materials_of = mean_materials)
      : rays(through), materials(materials_of(pack)) {}

  const rays::PackRays& rays;
  std::vector<MeanMaterial> materials;
};

/// What the g-buffer holds along `way`, of unit length: backs are not drawn, but of double-sided materials. Adds the
/// rays that it cast to `rays_cast`.
std::optional<rays::Hit> first_seen(const SampledScene& scene, const glm::vec3& eye_ws, const glm::vec3& way,
                                    uint64_t& rays_cast);
/// A place on what first_seen() found, a little off it, and the side of it that is seen.
struct SeenPlace {
  glm::vec3 position_ws;
  glm::vec3 normal_ws;  // of the triangle, facing the eye
};
SeenPlace seen_place(const rays::Hit& hit, const glm::vec3& eye_ws, const glm::vec3& way);
/// Illuminance of a surface that faces the light, were nothing in its way, and the way to it.
struct Incoming {
  glm::vec3 illuminance;
  glm::vec3 to_light;
};
Incoming incoming(const pack::Light& light, const glm::vec3& place_ws);
/// Whether a light sees a place, were its range endless. Casts one ray.
bool sees(const rays::PackRays& rays, const pack::Light& light, const glm::vec3& place_ws);

/// The lights that samples are taken of: copies, so that a search may go on while the world changes.
struct SampledLights {
  std::vector<pack::Light> shadowed;
  std::vector<pack::Light> shadowless;
};
/// `ids`: of lights that throw a shadow. Those that throw none are all of the world's.
SampledLights sampled_lights(const World& world, std::span<const LightId> ids);

struct SampleSettings {
  uint32_t columns = 64;  // of the grid of points over the picture
  uint32_t rows = 36;
  uint32_t scatter = 0;              // another number, other places in the grid's cells
  Ambient ambient;                   // as RenderSettings has it
  float headlight = 0.0f;            // likewise
  std::optional<float> exposure_ev;  // absent: from the points' own brightness, as shading/exposure.comp does
};

/// Numbers of lights are indices into lights(). Radiance is exposed: what the tone curve gets.
class LightSamples {
 public:
  struct Point {
    glm::vec3 position_ws;   // a little off its surface
    glm::vec3 normal_ws;     // of the triangle, facing the eye
    glm::vec3 unshadowable;  // radiance that no shadow takes: emission, ambient, headlight, and lights that throw none
    glm::vec3 reference;     // radiance with a shadow map for each light
  };
  /// What a light adds to a point that it sees, wherever that is not nothing.
  struct Contribution {
    uint32_t point;
    glm::vec3 radiance;
  };

  /// `scene` must outlive this. Throws SearchStopped.
  LightSamples(const SampledScene& scene, SampledLights lights, const Camera& camera, float aspect,
               const SampleSettings& settings, const std::stop_token& stop = {});

  const SampledLights& sampled_lights() const { return lights_; }
  /// That throw a shadow.
  std::span<const pack::Light> lights() const { return lights_.shadowed; }
  const pack::Light& light(uint32_t light) const { return lights_.shadowed[light]; }
  std::span<const Point> points() const { return points_; }
  std::span<const Contribution> contributions(uint32_t light) const { return contributions_[light]; }
  uint32_t cell_count() const { return cell_count_; }  // points, and cells of the grid that see nothing or no light
  float exposure_ev() const { return exposure_ev_; }

  /// Whether a light sees a point, were its range endless. Asked once, remembered.
  bool sees(uint32_t light, uint32_t point) const {
    uint8_t& known = sees_[size_t{light} * points_.size() + point];
    if (known == unknown) known = is_lit(light, points_[point].position_ws);
    return known != 0;
  }
  /// The same for any place; not remembered.
  bool is_lit(uint32_t light, const glm::vec3& place_ws) const;
  /// Where what stands nearest to a point or spot light blocks its way to a place, 0 (the light) to 1; 1 where nothing
  /// does.
  float blocked_at(uint32_t light, const glm::vec3& place_ws) const;
  uint64_t rays_cast() const { return rays_cast_; }

 private:
  static constexpr uint8_t unknown = 2;

  void place_points(const Camera& camera, float aspect, const SampleSettings& settings, const std::stop_token& stop);
  glm::vec3 added_by(const pack::Light& light, uint32_t point, const Camera& camera) const;
  void light_points(const Camera& camera, const std::stop_token& stop);
  void expose(const std::optional<float>& exposure_ev);

  const SampledScene& scene_;
  SampledLights lights_;
  std::vector<Point> points_;
  std::vector<uint32_t> material_;  // of each point
  std::vector<std::vector<Contribution>> contributions_;
  mutable std::vector<uint8_t> sees_;  // light after light, a byte for each point: 0, 1 or unknown
  mutable uint64_t rays_cast_ = 0;
  uint32_t cell_count_ = 0;
  float exposure_ev_ = 0.0f;
};

}  // namespace chandelier
