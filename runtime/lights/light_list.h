// SPDX-License-Identifier: Apache-2.0
// The select stage: which lights are in view, and which of them share a shadow map.
#pragma once

#include <span>
#include <vector>

#include "frame_schema.h"
#include "lights/ambient.h"
#include "lights/light_clusters.h"
#include "lights/surroundings.h"
#include "recipe_schema.h"
#include "view/camera.h"
#include "world/world.h"

namespace chandelier {

/// The lights that can reach something in view and throw a shadow, those of one shadow map after each other, maps in
/// ascending order of their centre's id: with one light per map that is the order of ids. Selection by error may give a
/// light shares of several maps: then it stands in `lights` once for each, as bright as its share.
struct LightList {
  std::vector<frame::FrameLight> lights;
  std::vector<frame::ShadowMap> maps;         // their sizes, views and places are still open
  std::vector<float> map_authored_radius_m;   // of each map, as filter_radius_m: the largest radius of its lights
  std::vector<glm::vec3> map_direction_ws;    // the way that each map's centre shines: cascades are drawn along it
  std::vector<LightId> light_id;              // of each of `lights`
  std::vector<LightId> center;                // the light whose map each of `lights` takes
  std::vector<float> share;                   // how much of the light each of `lights` is; those of one add up to 1
  uint32_t lights_in_view = 0;                // each counted once, those without shadow too
  std::vector<frame::FrameLight> shadowless;  // in view, of no map: they shine through everything
  bool has_area_lights = false;               // a light of the world throws a shadow and has a radius, in view or not
  bool is_provisional = false;                // an error search for this view still runs

  uint32_t shadowed_in_view() const { return lights_in_view - static_cast<uint32_t>(shadowless.size()); }
};

/// What a selection depends on beside world, recipe and camera. What the recipe does not ask for may be missing.
struct SelectionInputs {
  Surroundings* surroundings = nullptr;  // of the same world; needed for walls, and to select by error
  Ambient ambient;                       // how bright the picture will be, to select by error
  float headlight = 0.0f;
  std::optional<float> exposure_ev;
  /// Each light's centre a frame ago, pack::none where it was not in view, which the recipe's stability favours (not
  /// where it selects by error). Of lights beyond its end none; may be empty.
  std::span<const LightId> previous_centers;
  /// For each light the one whose map it shall take; pack::none, or a directional light for another or the other way
  /// round, or the map that most of the light takes anyway, or beyond the end: as selected. May be empty.
  std::span<const LightId> centers;
  bool out_of_view = false;           // lights that the camera does not see are selected too
  bool search_beside_frames = false;  // an error search runs in a thread, and its last answer is taken until it ends
};

/// Point and spot lights may share a map, and directional lights among themselves. Throws std::invalid_argument where
/// the recipe needs surroundings and there are none, or centres are more than world.lights().
LightList select_lights(const World& world, const Recipe& recipe, const Camera& camera, float aspect,
                        const SelectionInputs& inputs = {});

/// Is any map of the list shared by lights of a group?
bool group_shares(const World& world, const LightList& list);

/// Expected RMSE of the shown picture against one shadow map for each light, hard where the light has no radius, of
/// what select_lights() made of the same recipe, camera and inputs: estimated_rmse().
double expected_rmse(const LightList& list, const Recipe& recipe, const Camera& camera, float aspect,
                     const SelectionInputs& inputs);

/// What LightCluster says of a map's lights, whether or not the recipe clustered them.
struct MapMeasures {
  float d_min_m;   // of the centre
  float spread_m;  // metric distance of the farthest light
};
/// One for each of `list.maps`. `list` is of the same world, recipe and camera.
std::vector<MapMeasures> measure_maps(const World& world, const LightList& list, const Recipe& recipe,
                                      const Camera& camera);

/// For each of world.lights() the light whose map it takes, or takes the largest share of; pack::none where it is not
/// in view.
std::vector<LightId> centers_by_light(const World& world, const LightList& list);

}  // namespace chandelier
