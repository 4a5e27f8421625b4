// SPDX-License-Identifier: Apache-2.0
// Filter answer `rays`: reads back what the camera sees, and has visibility textures filled by the caller.
#pragma once

#include "lights/light_list.h"
#include "shading/edges.h"
#include "shadows/filter/visibility_query.h"
#include "shadows/store/map_groups.h"

namespace chandelier {

/// Room for record_read_surfaces().
gpu::Buffer make_surface_readback(const gpu::Device& device, uint32_t width, uint32_t height);
/// Copies depth and surface, which must be ready to be sampled and are so again afterwards.
void record_read_surfaces(gpu::Commands cmd, const Targets& targets, const gpu::Buffer& readback);
/// One point a pixel, rows from the top, where shading has them too.
std::vector<SurfacePoint> surface_points(const gpu::Buffer& readback, const frame::ViewConstants& view);

/// What is asked about: the lights of a frame, each of which has a map of its own.
struct AskedLights {
  const LightList& list;
  float z_far_m;  // how far away a directional light stands
  glm::vec3 eye_ws;
};

/// Asks for the visibility of every light of a group; each must have a map of its own. `bytes` holds the group's
/// textures.
void fill_visibility(const AskedLights& lights, const MapGroup& group, std::span<const SurfacePoint> points,
                     uint32_t width, const VisibilitySource& source, std::span<uint8_t> bytes);

/// One point for each surface of edge pixels, in their order. Submits and waits.
std::vector<SurfacePoint> read_edge_points(const gpu::Device& device, const Edges& edges, const gpu::Buffer& view);
/// As fill_visibility(), of these points alone: a byte for each, then the group's next map.
void fill_edge_visibility(const AskedLights& lights, const MapGroup& group, std::span<const SurfacePoint> points,
                          const VisibilitySource& source, std::span<uint8_t> bytes);

}  // namespace chandelier
