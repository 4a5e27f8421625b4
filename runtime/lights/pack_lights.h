// SPDX-License-Identifier: Apache-2.0
// Records of lights, as the select stage and shading take them.
#pragma once

#include <vector>

#include "frame_schema.h"
#include "lights/light_clusters.h"
#include "pack_schema.h"
#include "recipe_schema.h"
#include "view/camera.h"
#include "world/world.h"

namespace chandelier {

inline bool is_directional(const pack::Light& light) {
  return light.type == pack::LightType::directional;
}

/// Ascending ids of lights whose sphere meets the view frustum (LightCluster §3.1.2), and of all directional ones; with
/// `out_of_view` of all.
std::vector<LightId> lights_in_view(const World& world, const Camera& camera, float aspect, bool out_of_view);
/// Takes those that throw no shadow out of `ids`, and returns them. Both stay in order.
std::vector<LightId> take_shadowless(const World& world, std::vector<LightId>& ids);

/// Of no map.
frame::FrameLight frame_light(const pack::Light& light);
/// As ShadowMap has filter_radius_m: a directional light's disc stands z_far away.
float source_radius_m(const pack::Light& light, float z_far_m);

lights::ClusterLight cluster_light(const pack::Light& light);
/// A directional light stands z_far away, wherever the receiver is. None ends nearer than another: the brightest is
/// looked at first.
lights::ClusterLight far_cluster_light(const pack::Light& light, float z_far_m);
lights::ClusterSettings cluster_settings(const Recipe& recipe, const Camera& camera);

}  // namespace chandelier
