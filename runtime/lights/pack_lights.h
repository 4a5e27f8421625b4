// SPDX-License-Identifier: Apache-2.0
// A pack's lights, as the select stage and shading take them.
#pragma once

#include <span>
#include <vector>

#include "frame/camera.h"
#include "frame/recipe.h"
#include "frame_schema.h"
#include "lights/light_clusters.h"
#include "pack_schema.h"

namespace chandelier {

inline bool is_directional(const pack::Light& light) {
  return light.type == pack::LightType::directional;
}

/// Numbers in the pack, ascending, of lights whose sphere meets the view frustum (LightCluster §3.1.2), and of all
/// directional ones; with `out_of_view` of all.
std::vector<uint32_t> lights_in_view(std::span<const pack::Light> lights, const Camera& camera, float aspect,
                                     bool out_of_view);
/// Takes those that throw no shadow out of `numbers`, and returns them. Both stay in order.
std::vector<uint32_t> take_shadowless(std::span<const pack::Light> lights, std::vector<uint32_t>& numbers);

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
