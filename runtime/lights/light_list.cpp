// SPDX-License-Identifier: Apache-2.0
// One shadow map per light (the reference), or per light cluster (LightCluster §3.1).
#include "lights/light_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "light_near.h"
#include "lights/light_clusters.h"
#include "lights/pack_lights.h"

namespace chandelier {
namespace {

// A light, and the light whose position its shadow map is drawn from.
struct Member {
  uint32_t light;
  uint32_t center;
  float map_range_m;
  float filter_radius_m;
  float share = 1.0f;  // of the light; the rest takes other maps
};

uint32_t index_in(std::span<const uint32_t> ascending, uint32_t number) {
  return static_cast<uint32_t>(std::lower_bound(ascending.begin(), ascending.end(), number) - ascending.begin());
}

bool by_center(const Member& a, const Member& b) {
  return a.center != b.center ? a.center < b.center : a.light < b.light;
}

// Ids as places among `numbers`; a centre that is not among them is none.
std::vector<uint32_t> as_places(std::span<const uint32_t> previous_centers, std::span<const uint32_t> numbers) {
  std::vector<uint32_t> place(previous_centers.size(), lights::no_center);
  for (uint32_t i = 0; i < numbers.size() && !place.empty(); ++i) place[numbers[i]] = i;
  std::vector<uint32_t> centers;
  for (uint32_t i = 0; i < numbers.size() && !place.empty(); ++i) {
    const uint32_t center = previous_centers[numbers[i]];
    centers.push_back(center < place.size() ? place[center] : lights::no_center);
  }
  return centers;
}

// LightCluster §3.2.2 takes d_min, which no member reaches, and shadows all those that stand nearer too softly. These
// parts of d_min and of the farthest member's distance came nearest to the reference (README.md of runtime/shadows).
constexpr float disc_per_d_min = 0.3f;
constexpr float disc_per_spread = 0.6f;

float area_radius_m(const Recipe& recipe, const lights::LightCluster& cluster) {
  return recipe.area_radius == AreaRadius::spread ? disc_per_spread * cluster.spread_m
                                                  : disc_per_d_min * cluster.d_min_m;
}

// `numbers` are the ids of the clustered lights.
std::vector<Member> members_of_light_clusters(std::span<const pack::Light> lights, std::span<const uint32_t> numbers,
                                              const Recipe& recipe, const Camera& camera,
                                              const SelectionInputs& inputs) {
  std::vector<lights::ClusterLight> spheres;
  for (const uint32_t i : numbers) spheres.push_back(cluster_light(lights[i]));
  lights::Blocked blocked;
  if (recipe.walls != WallTest::none)
    blocked = [&, &walls = inputs.surroundings->walls()](uint32_t a, uint32_t b) {
      return walls.between(recipe.walls, numbers[a], numbers[b]);
    };
  const std::vector<uint32_t> previous = as_places(inputs.previous_centers, numbers);
  lights::ClusterSettings settings = cluster_settings(recipe, camera);
  settings.previous_centers = previous;
  const auto result = lights::select_light_clusters(spheres, settings, blocked);
  std::vector<Member> members;
  for (uint32_t i = 0; i < numbers.size(); ++i) {
    const lights::LightCluster& joined = result.clusters[result.cluster_of_light[i]];
    // A lone light is as large as its author made it; d_min where nobody did (LightCluster §3.2.2).
    const bool is_as_authored = joined.light_count == 1 && lights[numbers[i]].radius_m > 0.0f;
    const float radius = is_as_authored ? 0.0f : area_radius_m(recipe, joined);
    members.push_back({numbers[i], numbers[joined.center], joined.range_m, radius});
  }
  return members;
}

// Directions that differ by less than d_init / z_far (as a chord) share a map, however the camera moves. A light that
// stands for itself alone is as hard as the sun.
std::vector<Member> members_of_directional_clusters(std::span<const pack::Light> lights,
                                                    std::span<const uint32_t> numbers, const Recipe& recipe,
                                                    const Camera& camera) {
  std::vector<lights::ClusterLight> far;
  for (const uint32_t i : numbers) far.push_back(far_cluster_light(lights[i], recipe.z_far_m));
  lights::ClusterSettings settings = cluster_settings(recipe, camera);
  settings.scaling = DistanceScaling::none;
  const auto result = lights::select_light_clusters(far, settings);
  std::vector<Member> members;
  for (uint32_t i = 0; i < numbers.size(); ++i) {
    const lights::LightCluster& joined = result.clusters[result.cluster_of_light[i]];
    const float radius = joined.light_count > 1 ? area_radius_m(recipe, joined) : 0.0f;
    members.push_back({numbers[i], numbers[joined.center], 0.0f, radius});
  }
  return members;
}

std::vector<Member> clustered(std::span<const pack::Light> lights, std::span<const uint32_t> in_view,
                              const Recipe& recipe, const Camera& camera, const SelectionInputs& inputs) {
  std::vector<uint32_t> directional, others;
  for (const uint32_t i : in_view) (is_directional(lights[i]) ? directional : others).push_back(i);
  auto members = members_of_light_clusters(lights, others, recipe, camera, inputs);
  const auto far = members_of_directional_clusters(lights, directional, recipe, camera);
  members.insert(members.end(), far.begin(), far.end());
  return members;
}

// Of the lights in view, as indices into them: whose map each light of a group shares.
std::vector<uint32_t> group_centers(std::span<const pack::Light> lights, std::span<const uint32_t> in_view,
                                    Recipe recipe, const Camera& camera) {
  recipe.walls = WallTest::none;  // which keep no group apart
  std::vector<uint32_t> grouped, centers(in_view.size());
  for (const uint32_t i : in_view)
    if (lights[i].group != 0) grouped.push_back(i);
  for (const Member& m : clustered(lights, grouped, recipe, camera, {}))
    centers[index_in(in_view, m.light)] = index_in(in_view, m.center);
  return centers;
}

ErrorTask error_task(const World& world, std::span<const LightId> in_view, std::vector<Member> clusters,
                     const Recipe& recipe, const Camera& camera, float aspect, const SelectionInputs& inputs) {
  std::sort(clusters.begin(), clusters.end(), by_center);
  std::vector<MapMember> of_clusters;
  for (const Member& m : clusters)
    of_clusters.push_back({index_in(in_view, m.light), index_in(in_view, m.center), m.filter_radius_m});
  return {.key = world_key(world, in_view),
          .view = {camera, aspect, inputs.ambient, inputs.headlight, inputs.exposure_ev},
          .recipe = recipe,
          .clusters = std::move(of_clusters),
          .group_centers = group_centers(world.lights(), in_view, recipe, camera)};
}

// What an error search chose, with how far each map must reach (LightCluster §3.1.3: C_att).
std::vector<Member> as_members(std::span<const pack::Light> lights, std::span<const LightId> in_view,
                               std::span<const MapMember> chosen) {
  std::vector<float> range_m(in_view.size(), 0.0f);
  for (const MapMember& m : chosen) {
    const pack::Light& light = lights[in_view[m.light]];
    const float apart = glm::distance(light.position_ws, lights[in_view[m.center]].position_ws);
    range_m[m.center] = std::max(range_m[m.center], apart + light.range_m);
  }
  std::vector<Member> members;
  for (const MapMember& m : chosen)
    members.push_back({in_view[m.light], in_view[m.center], range_m[m.center], m.filter_radius_m, m.share});
  return members;
}

std::vector<Member> one_map_each(std::span<const pack::Light> lights, std::span<const uint32_t> in_view) {
  std::vector<Member> members;
  for (uint32_t i : in_view) members.push_back({i, i, lights[i].range_m, 0.0f});
  return members;
}

// A selection by error depends on no frame before: else each answer would change what the next is asked, and a still
// picture might never rest.
std::vector<Member> select_by_error(const World& world, std::span<const LightId> in_view, const Recipe& recipe,
                                    const Camera& camera, float aspect, const SelectionInputs& inputs,
                                    bool& is_provisional) {
  const auto lights = world.lights();
  SelectionInputs of_frame = inputs;
  of_frame.previous_centers = {};
  const bool has_limits = recipe.max_maps || recipe.max_rmse;
  std::vector<Member> clusters;
  if (!has_limits || inputs.search_beside_frames) clusters = clustered(lights, in_view, recipe, camera, of_frame);
  ErrorDriven& errors = inputs.surroundings->by_error();
  const ErrorTask task = error_task(world, in_view, clusters, recipe, camera, aspect, inputs);
  if (!inputs.search_beside_frames) return as_members(lights, in_view, errors.select(task));
  const std::optional<ErrorAnswer> answer = errors.select_beside(task);
  is_provisional = !answer || !answer->is_current;
  return answer ? as_members(lights, in_view, answer->members) : clusters;
}

// Of all lights in view that throw a shadow. `is_provisional`: an error search for them still runs.
std::vector<Member> select_members(const World& world, std::span<const LightId> in_view, const Recipe& recipe,
                                   const Camera& camera, float aspect, const SelectionInputs& inputs,
                                   bool& is_provisional) {
  switch (recipe.select) {
    case Select::per_light:
      return one_map_each(world.lights(), in_view);
    case Select::light_clusters:
      return clustered(world.lights(), in_view, recipe, camera, inputs);
    case Select::error_driven:
      return select_by_error(world, in_view, recipe, camera, aspect, inputs, is_provisional);
  }
  refuse_answer(recipe.select);
}

// A light that shall have another map than it has most of takes that alone.
void move_to_held(std::span<const pack::Light> lights, std::span<const uint32_t> centers,
                  std::vector<Member>& members) {
  std::unordered_map<uint32_t, Member> most;
  for (const Member& member : members) {
    Member& largest = most.try_emplace(member.light, member).first->second;
    if (member.share > largest.share) largest = member;
  }
  const auto is_moved = [&](uint32_t light) {
    const uint32_t held = centers[light];
    return held < lights.size() && is_directional(lights[held]) == is_directional(lights[light]) &&
           lights[held].shadowless == 0 && held != most.at(light).center;
  };
  std::erase_if(members, [&](const Member& member) {
    return is_moved(member.light) && member.center != most.at(member.light).center;
  });
  for (Member& member : members) {
    if (!is_moved(member.light)) continue;
    member.center = centers[member.light];
    member.share = 1.0f;
  }
}

// Lights take the maps that they are told to; a map's C_att and area light follow its lights (LightCluster §3.1.3).
void hold_centers(std::span<const pack::Light> lights, std::span<const uint32_t> centers,
                  std::vector<Member>& members) {
  struct Map {
    float range_m = 0.0f;
    float filter_radius_m = 0.0f;
  };
  move_to_held(lights, centers, members);
  std::unordered_map<uint32_t, Map> maps;
  for (const Member& member : members) {
    const pack::Light& light = lights[member.light];
    const float apart = glm::distance(light.position_ws, lights[member.center].position_ws);
    Map& map = maps[member.center];
    if (!is_directional(light)) map.range_m = std::max(map.range_m, apart + light.range_m);
    map.filter_radius_m = std::max(map.filter_radius_m, member.filter_radius_m);
  }
  for (Member& member : members) {
    member.map_range_m = maps[member.center].range_m;
    member.filter_radius_m = maps[member.center].filter_radius_m;
  }
}

LightList make_list(std::span<const pack::Light> lights, std::vector<Member> members, float z_far_m) {
  std::sort(members.begin(), members.end(), by_center);
  LightList list;
  list.has_area_lights = std::any_of(lights.begin(), lights.end(), [](const pack::Light& light) {
    return light.shadowless == 0 && light.radius_m > 0.0f;
  });
  for (size_t i = 0; i < members.size(); ++i) {
    const Member& member = members[i];
    if (i == 0 || members[i - 1].center != member.center) {
      list.maps.push_back({.center_ws = lights[member.center].position_ws,
                           .range_m = member.map_range_m,
                           .near_m = pack::shadow_near_m(lights[member.center]),
                           .filter_radius_m = member.filter_radius_m,
                           .projection = is_directional(lights[member.center]) ? frame::Projection::cascade
                                                                               : frame::Projection::cube_face,
                           .first_light = static_cast<uint32_t>(i)});
      list.map_direction_ws.push_back(lights[member.center].direction_ws);
      list.map_authored_radius_m.push_back(0.0f);
    }
    frame::ShadowMap& map = list.maps.back();
    float& authored_m = list.map_authored_radius_m.back();
    authored_m = std::max(authored_m, source_radius_m(lights[member.light], z_far_m));
    map.filter_radius_m = std::max(map.filter_radius_m, authored_m);
    list.lights.push_back(frame_light(lights[member.light]));
    list.lights.back().radiant *= member.share;
    list.lights.back().map = static_cast<uint32_t>(list.maps.size() - 1);
    ++map.light_count;
    list.light_id.push_back(member.light);
    list.center.push_back(member.center);
    list.share.push_back(member.share);
  }
  return list;
}

// By how much a map's disc is larger than the largest of its lights. The widths of blurs add up as squares.
float added_radius_m(const LightList& list, uint32_t map) {
  const float disc_m = list.maps[map].filter_radius_m, authored_m = list.map_authored_radius_m[map];
  return std::sqrt(std::max(0.0f, disc_m * disc_m - authored_m * authored_m));
}

// Lights that came later have none.
std::vector<LightId> one_each(std::span<const LightId> centers, size_t lights, const char* what) {
  if (centers.size() > lights)
    throw std::invalid_argument(std::string(what) + ": more than one per light of the world (" +
                                std::to_string(centers.size()) + " for " + std::to_string(lights) + ")");
  std::vector<LightId> of_all(centers.begin(), centers.end());
  if (!centers.empty()) of_all.resize(lights, pack::none);
  return of_all;
}

}  // namespace

LightList select_lights(const World& world, const Recipe& recipe, const Camera& camera, float aspect,
                        const SelectionInputs& inputs) {
  const auto lights = world.lights();
  const bool looks_around =
      recipe.select == Select::error_driven || (recipe.select != Select::per_light && recipe.walls != WallTest::none);
  if (looks_around && !inputs.surroundings)
    throw std::invalid_argument("select_lights: the recipe needs to know the lights' surroundings");
  const auto previous_centers = one_each(inputs.previous_centers, lights.size(), "previous centres");
  const auto centers = one_each(inputs.centers, lights.size(), "centres");
  SelectionInputs inputs_of_all = inputs;
  inputs_of_all.previous_centers = previous_centers;
  auto in_view = lights_in_view(world, camera, aspect, inputs.out_of_view);
  const auto shadowless = take_shadowless(world, in_view);
  bool is_provisional = false;
  auto members = select_members(world, in_view, recipe, camera, aspect, inputs_of_all, is_provisional);
  if (!centers.empty()) hold_centers(lights, centers, members);
  LightList list = make_list(lights, std::move(members), recipe.z_far_m);
  for (const LightId id : shadowless) list.shadowless.push_back(frame_light(lights[id]));
  list.lights_in_view = static_cast<uint32_t>(in_view.size() + shadowless.size());
  list.is_provisional = is_provisional;
  return list;
}

bool group_shares(const World& world, const LightList& list) {
  const auto lights = world.lights();
  for (size_t i = 0; i < list.lights.size(); ++i)
    if (list.center[i] != list.light_id[i] && lights[list.light_id[i]].group != 0) return true;
  return false;
}

std::vector<LightId> centers_by_light(const World& world, const LightList& list) {
  std::vector<LightId> centers(world.lights().size(), pack::none);
  std::vector<float> largest(centers.size(), 0.0f);
  for (size_t i = 0; i < list.center.size(); ++i) {
    if (list.share[i] <= largest[list.light_id[i]]) continue;
    largest[list.light_id[i]] = list.share[i];
    centers[list.light_id[i]] = list.center[i];
  }
  return centers;
}

std::vector<MapMeasures> measure_maps(const World& world, const LightList& list, const Recipe& recipe,
                                      const Camera& camera) {
  const auto lights = world.lights();
  const lights::ClusterSettings settings = cluster_settings(recipe, camera);
  const auto placed = [&](uint32_t light) {
    return is_directional(lights[light]) ? far_cluster_light(lights[light], recipe.z_far_m)
                                         : cluster_light(lights[light]);
  };
  std::vector<MapMeasures> measures;
  for (const frame::ShadowMap& map : list.maps) {
    const glm::vec3 center_ws = placed(list.center[map.first_light]).position_ws;
    MapMeasures of_map{
        map.projection == frame::Projection::cascade ? recipe.d_init_m : lights::scaled_d_min(settings, center_ws),
        0.0f};
    for (uint32_t i = map.first_light; i < map.first_light + map.light_count; ++i) {
      const double distance_m = lights::metric_distance_m(placed(list.light_id[i]), center_ws);
      of_map.spread_m = std::max(of_map.spread_m,
                                 static_cast<float>(std::min(distance_m, double{std::numeric_limits<float>::max()})));
    }
    measures.push_back(of_map);
  }
  return measures;
}

double expected_rmse(const LightList& list, const Recipe& recipe, const Camera& camera, float aspect,
                     const SelectionInputs& inputs) {
  if (!inputs.surroundings) throw std::invalid_argument("expected_rmse: needs to know the lights' surroundings");
  std::vector<uint32_t> in_view = list.light_id;
  in_view.insert(in_view.end(), list.center.begin(), list.center.end());  // held ones may be out of view
  std::sort(in_view.begin(), in_view.end());
  in_view.erase(std::unique(in_view.begin(), in_view.end()), in_view.end());
  std::vector<MapMember> members;
  for (size_t i = 0; i < list.lights.size(); ++i)
    members.push_back({index_in(in_view, list.light_id[i]), index_in(in_view, list.center[i]),
                       added_radius_m(list, list.lights[i].map), list.share[i]});
  return inputs.surroundings->by_error().expected_rmse(
      in_view, members, {camera, aspect, inputs.ambient, inputs.headlight, inputs.exposure_ev}, recipe);
}

}  // namespace chandelier
