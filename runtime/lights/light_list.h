// SPDX-License-Identifier: Apache-2.0
// The select stage: which lights are in view, and which of them share a shadow map.
#pragma once

#include <span>
#include <vector>

#include "frame/camera.h"
#include "frame/recipe.h"
#include "frame_schema.h"
#include "lights/light_clusters.h"
#include "lights/surroundings.h"
#include "pack_schema.h"

namespace chandelier {

/// The lights that can reach something in view and throw a shadow, those of one shadow map after each other, maps in
/// ascending order of their centre's number in the pack: with one light per map that is the pack's order. Selection by
/// error may give a light shares of several maps: then it stands in `lights` once for each, as bright as its share.
struct LightList {
  std::vector<frame::FrameLight> lights;
  std::vector<frame::ShadowMap> maps;         // cube, first_view and view_count are still open
  std::vector<float> map_authored_radius_m;   // of each map, as filter_radius_m: the largest radius of its lights
  std::vector<glm::vec3> map_direction_ws;    // the way that each map's centre shines: cascades are drawn along it
  std::vector<uint32_t> pack_light;           // number in the pack, of each of `lights`
  std::vector<uint32_t> center;               // number in the pack of the light whose map each of `lights` takes
  std::vector<float> share;                   // how much of the light each of `lights` is; those of one add up to 1
  uint32_t lights_in_view = 0;                // each counted once, those without shadow too
  std::vector<frame::FrameLight> shadowless;  // in view, of no map: they shine through everything
  bool has_area_lights = false;               // a light of the pack throws a shadow and has a radius, in view or not

  uint32_t shadowed_in_view() const { return lights_in_view - static_cast<uint32_t>(shadowless.size()); }
};

/// What a selection may go on from beside the lights. What the recipe does not ask for may be missing.
struct SelectAids {
  Surroundings* surroundings = nullptr;  // of the same pack; needed for walls, and to select by error
  float ambient = 0.0f;                  // how bright the picture will be, to select by error
  float headlight = 0.0f;
  std::optional<float> exposure_ev;
  /// Each light's centre a frame ago, pack::none where it was not in view, to which the recipe's stability clings; or
  /// empty.
  std::span<const uint32_t> previous_centers;
  /// For each light the number of the light whose map it shall take; pack::none, or a directional light for another or
  /// the other way round, or the map that most of the light takes anyway: as selected. May be empty.
  std::span<const uint32_t> centers;
  bool out_of_view = false;  // lights that the camera does not see are selected too
};

/// Point and spot lights may share a map, and directional lights among themselves. Throws std::invalid_argument where
/// the recipe needs surroundings and there are none, or centres are not one per light.
LightList select_lights(std::span<const pack::Light> lights, const Recipe& recipe, const Camera& camera, float aspect,
                        const SelectAids& aids = {});

/// Is any map of the list shared by lights of a group?
bool group_shares(std::span<const pack::Light> lights, const LightList& list);

/// Expected RMSE of the shown picture against one shadow map for each light, hard where the light has no radius, of
/// what select_lights() made of the same recipe, camera and aids: estimated_rmse().
double expected_rmse(const LightList& list, const Recipe& recipe, const Camera& camera, float aspect,
                     const SelectAids& aids);

/// What LightCluster says of a map's lights, whether or not the recipe clustered them.
struct MapMeasures {
  float d_min_m;   // of the centre
  float spread_m;  // metric distance of the farthest light
};
/// One for each of `list.maps`. `list` is of the same lights, recipe and camera.
std::vector<MapMeasures> measure_maps(std::span<const pack::Light> lights, const LightList& list, const Recipe& recipe,
                                      const Camera& camera);

/// Of `light_count` lights of the pack the one whose map each takes, or takes the largest share of; pack::none where it
/// is not in view.
std::vector<uint32_t> centers_of_pack_lights(const LightList& list, size_t light_count);

}  // namespace chandelier
