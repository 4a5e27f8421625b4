// SPDX-License-Identifier: Apache-2.0
// Looks for the mistakes that exporters and units make. A false alarm is worse than a miss, so each rule must be
// certain.
#include "light_audit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

#include "light_near.h"
#include "light_rays.h"

namespace chandelier::baker {
namespace {

using Numbers = std::vector<size_t>;  // of lights

constexpr double sphere_sr = 4 * 3.14159265358979323846;
constexpr double exporter_lumens_per_watt = 683;  // what glTF exporters take
constexpr int rays = 32;                          // from a suspicious light
constexpr double sunlight_lx = 1e5;               // direct, at noon
constexpr double fixture_m = 0.3;  // no room is this small: nearer surfaces around a light are its own lamp

struct Audit {
  const Scene& scene;
  const pack::Contents& pack;
  PassReport& pass;
  Warnings& warnings;

  /// The same number in both, as make_lights puts one after the other.
  const pack::Light& baked(size_t light) const { return pack.lights[light]; }
  const Light& authored(size_t light) const { return scene.lights[light]; }

  void name(const char* count, const std::string& what, const Numbers& lights) {
    if (lights.empty()) return;
    pass.count(count, static_cast<double>(lights.size()));
    for (const size_t i : lights) {
      warnings.add("scene", "lights", what, authored(i).name.empty() ? authored(i).where : authored(i).name);
    }
  }
};

bool is_near(double value, double expected, double tolerance) {
  return std::abs(value - expected) <= tolerance * expected;
}

double brightest_cd(const pack::Light& light) {
  return double{light.intensity} * std::max({light.color.r, light.color.g, light.color.b});
}

// ---- Defaults -------------------------------------------------------------------------------------------------------

/// Whose default the intensity is, if it is one. Blender's lights start at 10 W, in its first scene at 1000 W; 100 W
/// are as common. Its exporter writes 683 W / 4π (standard), W / 4π (unitless) or W (raw) as candela.
std::string default_of(double intensity) {
  if (intensity == 1) return "glTF's default";
  for (const int watts : {10, 100, 1000}) {
    for (const double factor : {exporter_lumens_per_watt / sphere_sr, 1 / sphere_sr, 1.0}) {
      if (is_near(intensity, watts * factor, 1e-4)) return fmt::format("what Blender writes for {} W", watts);
    }
  }
  return {};
}

/// Lights that nobody touched: all have the same default strength, are white, and none has a range. A scene with one
/// light proves nothing.
void audit_defaults(Audit& audit, const Numbers& placed) {
  if (placed.size() < 2) return;
  const float intensity = audit.baked(placed[0]).intensity;
  const bool untouched = std::ranges::all_of(placed, [&](size_t i) {
    const pack::Light& light = audit.baked(i);
    return light.intensity == intensity && light.color == glm::vec3(1) &&
           light.range_source == pack::RangeSource::derived;
  });
  const std::string whose = default_of(intensity);
  if (!untouched || whose.empty()) return;
  audit.name("all_default",
             fmt::format("all {} are white with {} cd, {}: was their strength ever set?", placed.size(),
                         to_text(intensity), whose),
             placed);
}

// ---- Units ----------------------------------------------------------------------------------------------------------

/// Mistakes with units, recognized by the lumens per watt that they lead to. 683 is right. Real lamps have fewer; any
/// other number may be a choice, so it is not reported.
struct Mixup {
  double lumens_per_watt;
  const char* count;
  const char* what;
};
constexpr std::array<Mixup, 5> mixups = {{
    {exporter_lumens_per_watt * exporter_lumens_per_watt, "watts_twice",
     "683 times too bright: power_w was turned to lumens twice"},
    {exporter_lumens_per_watt * sphere_sr, "lumens_as_candela",
     "12.6 times too bright: they have lumens where glTF has candela"},
    {exporter_lumens_per_watt / sphere_sr, "sphere_twice", "12.6 times too dark: power_w was divided by 4 pi twice"},
    {sphere_sr, "watts_as_candela", "54 times too dark: they have watts where glTF has candela"},
    {1, "radiometric", "683 times too dark: they have watts per steradian where glTF has candela"},
}};

void audit_power(Audit& audit, const Numbers& placed) {
  for (const Mixup& mixup : mixups) {
    Numbers lights;
    for (const size_t i : placed) {
      const double power_w = audit.authored(i).power_w.value_or(0);
      if (power_w <= 0) continue;
      const double lumens = sphere_sr * audit.baked(i).intensity;
      if (is_near(lumens / power_w, mixup.lumens_per_watt, 2e-3)) lights.push_back(i);
    }
    audit.name(mixup.count, mixup.what, lights);
  }
}

/// The illuminance of the surfaces around a light, lux, at the median distance that rays find. Nothing if most rays hit
/// nothing.
std::optional<double> illuminance_lx(const pack::Contents& pack, const pack::Light& light) {
  std::vector<double> distances;
  for (const glm::dvec3& way : directions_of(light, rays)) {
    const double distance = cast_ray(pack, glm::dvec3(light.position_ws), way, pack::shadow_near_m(light)).distance_m;
    if (distance <= light.range_m) distances.push_back(distance);
  }
  if (distances.size() < rays / 2) return std::nullopt;
  const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return brightest_cd(light) / (*middle * *middle);
}

/// Lights whose surroundings, outside of the lamp, are brighter than in sunlight.
Numbers brighter_than_sunlight(const Audit& audit, const Numbers& placed) {
  std::vector<uint8_t> found(placed.size(), 0);
  tbb::parallel_for(size_t{0}, placed.size(), [&](size_t i) {
    const pack::Light& light = audit.baked(placed[i]);
    if (brightest_cd(light) < sunlight_lx * fixture_m * fixture_m) return;
    const std::optional<double> lux = illuminance_lx(audit.pack, light);
    // Within its own lamp, a light may be this bright at the shade.
    found[i] = lux && *lux > sunlight_lx && brightest_cd(light) / *lux > fixture_m * fixture_m;
  });
  Numbers out;
  for (size_t i = 0; i < placed.size(); ++i) {
    if (found[i]) out.push_back(placed[i]);
  }
  return out;
}

double median_cd(const Audit& audit, std::span<const size_t> sorted) {
  return brightest_cd(audit.baked(sorted[sorted.size() / 2]));
}

/// The lights above a gap of more than 50 times in strength, if they are fewer than the others and about 683 times as
/// strong: some lights of the scene were converted with other units than the rest.
Numbers strong_minority(const Audit& audit, const Numbers& placed) {
  Numbers sorted = placed;
  const auto strength = [&](size_t i) { return brightest_cd(audit.baked(i)); };
  std::ranges::stable_sort(sorted, {}, strength);
  size_t first = 0;
  double widest = 50;
  for (size_t i = 1; i < sorted.size(); ++i) {
    const double gap = strength(sorted[i]) / strength(sorted[i - 1]);
    if (gap > widest) widest = gap, first = i;
  }
  if (first == 0 || sorted.size() - first >= first) return {};
  const std::span all(sorted);
  const double ratio = median_cd(audit, all.subspan(first)) / median_cd(audit, all.first(first));
  if (ratio < exporter_lumens_per_watt / 2 || ratio > exporter_lumens_per_watt * 2) return {};
  return {sorted.begin() + static_cast<ptrdiff_t>(first), sorted.end()};
}

/// Of the strong minority, those that also light what is around them 100 times as much as the others do: not
/// floodlights, which are strong because they are far away.
Numbers units_apart(const Audit& audit, const Numbers& placed) {
  const Numbers strong = strong_minority(audit, placed);
  if (strong.empty()) return {};
  const auto is_strong = [&](size_t i) { return std::ranges::find(strong, i) != strong.end(); };
  std::vector<double> usual_lx;
  for (size_t k = 0; k < placed.size() && usual_lx.size() < 64; ++k) {
    const std::optional<double> lux =
        is_strong(placed[k]) ? std::nullopt : illuminance_lx(audit.pack, audit.baked(placed[k]));
    if (lux) usual_lx.push_back(*lux);
  }
  if (usual_lx.empty()) return {};
  std::ranges::sort(usual_lx);
  Numbers out;
  for (const size_t i : strong) {
    const std::optional<double> lux = illuminance_lx(audit.pack, audit.baked(i));
    if (lux && *lux > 100 * usual_lx[usual_lx.size() / 2]) out.push_back(i);
  }
  std::ranges::sort(out);
  return out;
}

void audit_units(Audit& audit, const Numbers& placed) {
  audit_power(audit, placed);
  const Numbers apart = units_apart(audit, placed);
  audit.name("units_apart", "about 683 times as bright as the other lights: were watts turned to lumens twice?", apart);
  Numbers blinding = brighter_than_sunlight(audit, placed);
  std::erase_if(blinding, [&](size_t i) { return std::ranges::find(apart, i) != apart.end(); });
  audit.name("brighter_than_sunlight",
             "brighter than direct sunlight on most surfaces around them: were watts turned to lumens twice?",
             blinding);
}

// ---- Places ---------------------------------------------------------------------------------------------------------

/// Whether a closed shell around the light blocks it: most rays start inside and hit the shell's back first. Around a
/// lamp in a room of a closed building they hit the room first. A visible back (a double-sided material) may be meant
/// to be lit, unless it is as near as a bulb. A surface that is nearer than shadow maps see casts no shadow.
bool is_swallowed(const pack::Contents& pack, const pack::Light& light) {
  const glm::dvec3 from(light.position_ws);
  const std::vector<glm::dvec3> ways = directions_of(light, rays);
  int inside = 0, kept = 0;
  for (size_t i = 0; i < ways.size(); ++i) {
    const RayHit hit = cast_ray(pack, from, ways[i], pack::shadow_near_m(light));
    if (hit.shells_around > 0) ++inside;
    if (i == 1 && inside == 0) return false;  // two rays found no shell around it
    if (hit.closed_back && hit.distance_m <= light.range_m && (!hit.double_sided || hit.distance_m < fixture_m)) {
      ++kept;
    }
  }
  return inside > rays / 2 && kept > rays / 2;
}

/// Lights whose shadow maps miss the nearest surface: a shade, or a wall that they are in.
void audit_touching(Audit& audit, const Numbers& placed) {
  constexpr double least_m = pack::least_shadow_near_m / pack::shadow_near_per_distance;
  Numbers touching;
  for (const size_t i : placed) {
    pack::Light close = audit.baked(i);
    if (close.shadowless || close.dynamic || !(close.nearest_caster_m < least_m)) continue;
    close.range_m = static_cast<float>(least_m);
    close.bounds_center_ws = close.position_ws;
    close.bounds_radius_m = close.range_m;
    if (reaches_anything(audit.pack, close)) touching.push_back(i);  // so it is in the cone
  }
  audit.name("touching_a_surface",
             fmt::format("within {:.2g} mm of a surface, which may cast no shadow from their light", 1000 * least_m),
             touching);
}

void audit_places(Audit& audit, const Numbers& placed) {
  if (audit.pack.batch_instances.empty()) return;  // lights without a scene
  const bool any_closed = std::ranges::any_of(audit.pack.batches, [](const pack::Batch& b) { return b.closed == 1; });
  enum : uint8_t { fine, swallowed, alone };
  std::vector<uint8_t> found(placed.size(), fine);
  tbb::parallel_for(size_t{0}, placed.size(), [&](size_t i) {
    const pack::Light& light = audit.baked(placed[i]);
    if (light.dynamic) return;  // its position may change
    if (!reaches_anything(audit.pack, light)) {
      found[i] = alone;
    } else if (any_closed && is_swallowed(audit.pack, light)) {
      found[i] = swallowed;
    }
  });
  Numbers inside, nothing;
  for (size_t i = 0; i < placed.size(); ++i) {
    if (found[i] == swallowed) inside.push_back(placed[i]);
    if (found[i] == alone) nothing.push_back(placed[i]);
  }
  audit.name("inside_closed", "inside closed geometry, whose shadow blocks their light", inside);
  audit.name("reaching_nothing", "reaching nothing: no triangle is within their range and cone", nothing);
}

// ---- Groups ---------------------------------------------------------------------------------------------------------

void audit_groups(Audit& audit) {
  std::vector<std::array<bool, 2>> holds(audit.pack.lights.size() + 1);  // of each group: placed, directional lights
  Numbers opted_out, mixed, shadowless;
  for (size_t i = 0; i < audit.pack.lights.size(); ++i) {
    const pack::Light& light = audit.baked(i);
    holds[light.group][light.type == pack::LightType::directional] = true;
    if (light.group != 0 && light.unclustered) opted_out.push_back(i);
    if (light.group != 0 && light.shadowless) shadowless.push_back(i);
  }
  for (size_t i = 0; i < audit.pack.lights.size(); ++i) {
    const pack::Light& light = audit.baked(i);
    const bool both = holds[light.group][0] && holds[light.group][1];
    if (light.group != 0 && both && light.type == pack::LightType::directional) mixed.push_back(i);
  }
  audit.name("grouped_and_unclustered", "in a group although cluster is false: they share the group's shadow map",
             opted_out);
  audit.name("grouped_and_shadowless", "in a group although shadow is false: they get no shadow map", shadowless);
  audit.name("mixed_groups", "directional in a group with lights of another type: they share no map with those", mixed);
}

}  // namespace

void audit_lights(const Scene& scene, const pack::Contents& pack, PassReport& pass, Warnings& warnings) {
  Audit audit = {scene, pack, pass, warnings};
  Numbers placed;
  for (size_t i = 0; i < pack.lights.size(); ++i) {
    if (pack.lights[i].type != pack::LightType::directional) placed.push_back(i);
  }
  audit_defaults(audit, placed);
  audit_units(audit, placed);
  audit_places(audit, placed);
  audit_touching(audit, placed);
  audit_groups(audit);
}

}  // namespace chandelier::baker
