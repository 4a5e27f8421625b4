// SPDX-License-Identifier: Apache-2.0
// Views are tested with a coarse grid of rays, and judged by the number of rays that end on a lit surface.
#include "player/default_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "lights/light_samples.h"
#include "lights/pack_lights.h"

namespace chandelier::player {
namespace {

constexpr uint32_t columns = 16, rows = 9;
constexpr float grid_aspect = 16.0f / 9.0f;  // independent of the picture's, so that the size does not change the view
constexpr size_t most_lights = 512;          // that are tested, evenly chosen
constexpr size_t most_shadow_rays = 8;       // per place, to the lights that would be brightest there
constexpr float enough = 0.1f;               // of the surfaces in view are lit

constexpr size_t places = 4;  // to stand at, far from each other
constexpr int ways = 8;       // to step back from each
constexpr float step_back = 0.85f;
constexpr float eye_height_m = 1.6f;
constexpr float eye_share = 0.6f;         // of the height of a low room
constexpr float target_share = 0.8f;      // of the eye's height: a little down
constexpr float farthest_share = 0.5f;    // of a light's range
constexpr float inside_yfov_rad = 1.05f;  // 60 degrees
constexpr float far_enough_m = 30.0f;     // a farther surface is no better
constexpr float far_away_m = 1e6f;
constexpr int most_floors = 4;

const glm::vec3 down(0.0f, -1.0f, 0.0f);

struct Box {
  glm::vec3 low{INFINITY};
  glm::vec3 high{-INFINITY};
};

class Viewer {
 public:
  explicit Viewer(const pack::View& pack) : pack_(pack), rays_(pack), scene_(pack, rays_) {
    const size_t count = pack.lights.size();
    const size_t asked = std::min(count, most_lights);
    for (size_t i = 0; i < asked; ++i) lights_.push_back(&pack.lights[i * count / asked]);
  }

  struct Seen {
    uint32_t surfaces = 0;  // that a light could change
    uint32_t lit = 0;       // of them
    float reach_m = 0.0f;   // sum of the distances of the lit ones, so that a wall in front of the eye does not win
  };
  Seen see(const Camera& camera) const;

  /// A box around all surfaces that a light could change and that do not glow.
  Box unglowing() const;
  /// Cameras near lights that look past them, sorted by how far they could step back.
  std::vector<Camera> inside() const;

 private:
  struct Stand {
    Camera camera;
    float back_m;  // from below the light
  };

  bool is_lit(const SeenPlace& place) const;
  float way_ahead_m(const glm::vec3& from_ws, const glm::vec3& way, float most_m) const;
  std::vector<const pack::Light*> scattered_lights() const;
  void stand_near(const pack::Light& light, std::vector<Stand>& stands) const;

  pack::View pack_;
  rays::PackRays rays_;
  SampledScene scene_;
  std::vector<const pack::Light*> lights_;
};

bool Viewer::is_lit(const SeenPlace& place) const {
  if (lights_.empty()) return true;
  std::vector<std::pair<float, const pack::Light*>> brightest;
  for (const pack::Light* light : lights_) {
    const Incoming in = incoming(*light, place.position_ws);
    const float lx = glm::dot(in.illuminance, glm::vec3(1.0f)) * glm::dot(place.normal_ws, in.to_light);
    if (lx > 0.0f) brightest.emplace_back(-lx, light);
  }
  const size_t asked = std::min(brightest.size(), most_shadow_rays);
  std::partial_sort(brightest.begin(), brightest.begin() + static_cast<ptrdiff_t>(asked), brightest.end());
  return std::any_of(brightest.begin(), brightest.begin() + static_cast<ptrdiff_t>(asked), [&](const auto& each) {
    return each.second->shadowless != 0 || sees(rays_, *each.second, place.position_ws);
  });
}

Viewer::Seen Viewer::see(const Camera& camera) const {
  const CameraAxes axes = axes_of(camera);
  const float half_height = std::tan(camera.yfov_rad * 0.5f);
  Seen seen;
  uint64_t rays_cast = 0;
  for (uint32_t cell = 0; cell < columns * rows; ++cell) {
    const float x = 2.0f * (static_cast<float>(cell % columns) + 0.5f) / columns - 1.0f;
    const float y = 1.0f - 2.0f * (static_cast<float>(cell / columns) + 0.5f) / rows;
    const glm::vec3 way =
        glm::normalize(axes.forward + axes.right * (x * half_height * grid_aspect) + axes.up * (y * half_height));
    const auto hit = first_seen(scene_, camera.eye_ws, way, rays_cast);
    if (!hit || scene_.materials[hit->material].unlit) continue;
    ++seen.surfaces;
    if (!is_lit(seen_place(*hit, camera.eye_ws, way))) continue;
    ++seen.lit;
    seen.reach_m += std::min(hit->distance_m, far_enough_m);
  }
  return seen;
}

Box Viewer::unglowing() const {
  Box box;
  for (const pack::BatchInstance& draw : pack_.batch_instances) {
    const MeanMaterial& material = scene_.materials[pack_.batches[draw.batch].material];
    if (material.unlit || material.emissive != glm::vec3(0.0f)) continue;
    box.low = glm::min(box.low, draw.bounds_min_ws);
    box.high = glm::max(box.high, draw.bounds_max_ws);
  }
  return box;
}

float Viewer::way_ahead_m(const glm::vec3& from_ws, const glm::vec3& way, float most_m) const {
  const auto hit = rays_.first_hit(from_ws, way, most_m);
  return hit ? hit->distance_m : most_m;
}

// First the place nearest to their centre, then always the one farthest from those chosen.
std::vector<const pack::Light*> Viewer::scattered_lights() const {
  std::vector<const pack::Light*> placed;
  glm::dvec3 sum(0.0);
  for (const pack::Light* light : lights_) {
    if (is_directional(*light)) continue;
    placed.push_back(light);
    sum += glm::dvec3(light->position_ws);
  }
  if (placed.empty()) return placed;
  const glm::vec3 middle(sum / static_cast<double>(placed.size()));
  std::vector<float> apart_m;
  for (const pack::Light* light : placed) apart_m.push_back(-glm::distance(light->position_ws, middle));
  std::vector<const pack::Light*> chosen;
  while (chosen.size() < std::min(places, placed.size())) {
    const auto farthest = std::max_element(apart_m.begin(), apart_m.end());
    const pack::Light* const light = placed[static_cast<size_t>(farthest - apart_m.begin())];
    for (size_t i = 0; i < placed.size(); ++i) {
      const float distance = glm::distance(placed[i]->position_ws, light->position_ws);
      apart_m[i] = chosen.empty() ? distance : std::min(apart_m[i], distance);
    }
    chosen.push_back(light);
  }
  return chosen;
}

// The room between floor and ceiling that a light is in; if that is only its bulb or shade, the room below.
struct Room {
  float floor_y;
  float height_m;
};

std::optional<Room> room_of(const rays::PackRays& rays, const glm::vec3& light_ws) {
  std::vector<Room> rooms;
  glm::vec3 from = light_ws;
  for (int i = 0; i < most_floors; ++i) {
    const auto hit = rays.first_hit(from, down, far_away_m);
    if (!hit) break;
    rooms.push_back({from.y - hit->distance_m, hit->distance_m});
    from.y -= hit->distance_m + rays::PackRays::end_gap_m(light_ws, from + down * hit->distance_m);
  }
  if (rooms.empty()) return std::nullopt;
  float highest_m = 0.0f;
  for (const Room& room : rooms) highest_m = std::max(highest_m, room.height_m);
  const auto room =
      std::find_if(rooms.begin(), rooms.end(), [&](const Room& each) { return each.height_m >= 0.5f * highest_m; });
  if (room == rooms.begin()) {
    const auto ceiling = rays.first_hit(light_ws, -down, far_away_m);
    room->height_m += ceiling ? ceiling->distance_m : far_away_m;
  }
  return *room;
}

// Steps back from below the light as far as possible, and looks back past the light to the other side.
void Viewer::stand_near(const pack::Light& light, std::vector<Stand>& stands) const {
  const auto room = room_of(rays_, light.position_ws);
  const float eye_m = room ? std::min(eye_height_m, eye_share * room->height_m) : 0.0f;
  glm::vec3 place = light.position_ws;
  if (room) place.y = room->floor_y + eye_m;
  const glm::vec3 target = place - glm::vec3(0.0f, (1.0f - target_share) * eye_m, 0.0f);
  for (int i = 0; i < ways; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / ways;
    const glm::vec3 back(std::cos(angle), 0.0f, std::sin(angle));
    const float free_m = way_ahead_m(place, back, farthest_share * light.range_m);
    const glm::vec3 eye = place + back * (step_back * free_m);
    if (!(glm::distance(eye, place) > 0.25f * eye_m) || !(glm::distance(eye, target) > 1e-6f)) continue;
    Camera camera = camera_looking_at(eye, target, inside_yfov_rad);
    camera.znear_m = std::min(camera.znear_m, 0.5f * (1.0f - step_back) * free_m);
    stands.push_back({camera, step_back * free_m});
  }
}

std::vector<Camera> Viewer::inside() const {
  std::vector<Stand> stands;
  for (const pack::Light* light : scattered_lights()) stand_near(*light, stands);
  std::stable_sort(stands.begin(), stands.end(), [](const Stand& a, const Stand& b) { return a.back_m > b.back_m; });
  std::vector<Camera> cameras;
  for (const Stand& stand : stands) cameras.push_back(stand.camera);
  return cameras;
}

bool is_enough(const Viewer::Seen& seen) {
  return seen.lit > 0 && static_cast<float>(seen.lit) >= enough * static_cast<float>(seen.surfaces);
}

}  // namespace

NamedCamera default_view(const pack::View& pack, float aspect) {
  const auto framing = [](const Box& box, float of) { return camera_framing(box.low, box.high, of); };
  const Box all{pack.bake_info->bounds_min_ws, pack.bake_info->bounds_max_ws};
  const glm::dvec3& origin_m = pack.bake_info->origin_m;
  const NamedCamera whole{"", framing(all, aspect), origin_m, ChosenView::whole};
  if (pack.batch_instances.empty()) return whole;
  const Viewer viewer(pack);
  const Viewer::Seen seen_whole = viewer.see(framing(all, grid_aspect));
  if (is_enough(seen_whole)) return whole;

  const Box box = viewer.unglowing();
  const bool is_smaller =
      box.low.x <= box.high.x && glm::distance(box.low, box.high) < 0.9f * glm::distance(all.low, all.high);
  if (is_smaller && is_enough(viewer.see(framing(box, grid_aspect))))
    return {"", framing(box, aspect), origin_m, ChosenView::without_sky};

  NamedCamera best = whole;
  float farthest_m = 0.0f;
  for (const Camera& camera : viewer.inside()) {
    const Viewer::Seen seen = viewer.see(camera);
    if (seen.lit <= seen_whole.lit || seen.reach_m <= farthest_m) continue;
    farthest_m = seen.reach_m;
    best = {"", camera, origin_m, ChosenView::inside};
  }
  return best;
}

}  // namespace chandelier::player
