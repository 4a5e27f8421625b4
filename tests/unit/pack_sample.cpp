// SPDX-License-Identifier: Apache-2.0
// A small pack that has something in every section, and what tests do with files.
#include "pack_sample.h"

#include <stdlib.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>

#include "octahedral.h"

namespace chandelier::pack::test {
namespace {

/// Two triangles, the second one masked, and a banner of one triangle that bones move.
void add_vertices(Contents& c) {
  c.positions = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, -0.5f}}, {{0, 0, 0}}, {{0.5f, 0, 0}}, {{0, 0.5f, 0}}};
  for (uint32_t i = 0; i < c.positions.size(); ++i) {
    const float f = static_cast<float>(i);
    c.vertex_attributes.push_back(
        {encode_normal({0, 0, 1}), encode_tangent({1, 0, 0, -1}), {0.25f * f, 0.5f}, {2.0f * f, -1}, 0xff804020u + i});
  }
  c.indices = {{0}, {1}, {2}, {0}, {2}, {3}, {4}, {5}, {6}};
  c.batches = {{{0, 0, 0}, 0, {1, 1, 0}, 3, {0, 0, -1}, 0.5f, {0, 0, 1}, 0, 0},
               {{0, 0, -0.5f}, 3, {1, 1, 0}, 3, {}, 1, {}, 1, 0},
               {{0, 0, 0}, 6, {0.5f, 0.5f, 0}, 3, {}, 1, {}, 1, 0}};
  c.meshes = {{{0, 0, -0.5f}, 0, {1, 1, 0}, 2, 0, 3, 0, 4, 0, 0}, {{0, 0, 0}, 2, {0.5f, 0.5f, 0}, 1, 3, 1, 4, 3, 0, 3}};
}

/// The triangles stand on the left and on the right, the banner between them.
void add_instances(Contents& c) {
  const StringRef left = add_string(c, "left"), right = add_string(c, "right");
  c.instances.push_back({{{{1, 0, 0, -2}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0, 0, 0, none, none, left});
  c.instances.push_back({{{{1, 0, 0, 2}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0, 0, 1, none, none, right});
  c.batch_instances = {{{-2, 0, 0}, 0, {-1, 1, 0}, 0},
                       {{2, 0, 0}, 0, {3, 1, 0}, 1},
                       {{-2, 0, -0.5f}, 1, {-1, 1, 0}, 0},
                       {{2, 0, -0.5f}, 1, {3, 1, 0}, 1},
                       {{0.5f, 0, 0}, 2, {1, 0.5f, 0}, 2}};
  c.bake_info.bounds_min_ws = {-2, 0, -0.5f};
  c.bake_info.bounds_max_ws = {3, 1, 0};
  c.bake_info.origin_m = {1e6, -0.1, 250000.5};
  c.bake_info.unique_triangles = 3;
  c.bake_info.instanced_triangles = 5;
  c.bake_info.batch_triangles = 100;
  c.bake_info.range_threshold_lx = 0.05f;
  c.bake_info.position_error_m = 0.001f;
  c.bake_info.normal_error_rad = 0.0001f;
  c.bake_info.source = add_string(c, "hall.glb\nlamps.gltf");
}

void add_materials(Contents& c) {
  Material stone;
  stone.base_color_factor = {0.5f, 0.25f, 0.125f, 1};
  stone.roughness_factor = 0.75f;
  stone.normal_scale = 1;
  stone.base_color_texture = 0;
  stone.normal_texture = 1;
  stone.name = add_string(c, "stone");
  Material leaf = stone;
  leaf.alpha_mode = AlphaMode::mask;
  leaf.alpha_cutoff = 0.5f;
  leaf.double_sided = leaf.shadowless = 1;
  leaf.transmission_factor = 0.25f;
  leaf.name = add_string(c, "Blätter");
  c.materials = {stone, leaf};
  c.textures = {
      {{{{1, 0, 0}, {0, 1, 0}}}, 0, Wrap::repeat, Wrap::mirrored_repeat, Filter::linear, Filter::nearest},
      {{{{2, 0, 0.5f}, {0, 2, -0.25f}}}, 1, Wrap::clamp_to_edge, Wrap::repeat, Filter::linear, Filter::linear}};
  const auto raw = ImageCodec::raw;
  const auto bricks = add_string(c, "bricks.png"), flat = add_string(c, "flat"), sky = add_string(c, "sky.exr");
  c.images.push_back({0, 44, 44, 4, 2, 3, ImageFormat::rgba8_srgb, raw, 0, bricks});  // 4×2, 2×1, 1×1
  c.images.push_back({48, 4, 4, 1, 1, 1, ImageFormat::rgba8_unorm, raw, 0, flat});
  c.images.push_back({64, 512, 512, 8, 8, 1, ImageFormat::rgba16_sfloat, raw, 0, sky});
  for (int i = 0; i < 52; ++i) c.image_data.push_back(static_cast<std::byte>(i * 5));
  c.image_data.resize(64);
  for (int i = 0; i < 256; ++i) {  // half floats: 1 and a little more
    c.image_data.push_back(static_cast<std::byte>(i / 32));
    c.image_data.push_back(std::byte{0x3C});
  }
}

void add_lights(Contents& c) {
  Light point;
  point.position_ws = {1, 2, 3};
  point.range_m = 7;
  point.direction_ws = {0, 0, -1};
  point.intensity = 12.5f;
  point.color = {1, 0.5f, 0.25f};
  point.inner_cone_cos = 1;
  point.outer_cone_cos = -1;
  point.bounds_center_ws = point.position_ws;
  point.bounds_radius_m = 7;
  point.nearest_caster_m = 0.75f;
  point.priority = 128;
  point.group = 1;
  point.name = add_string(c, "bulb");
  Light spot = point;
  spot.position_ws = {1, 0.5f, -0.125f};
  spot.type = LightType::spot;
  spot.direction_ws = {0, -1, 0};
  spot.inner_cone_cos = 0.9f;
  spot.outer_cone_cos = 0.5f;
  spot.range_m = 15.8f;
  spot.range_source = RangeSource::derived;
  spot.bounds_center_ws = {1, 0.5f - 15.8f * 0.5f, -0.125f};  // through the rim of a cone of more than 45°
  spot.bounds_radius_m = 13.6833f;
  spot.voxel = 1;
  spot.shadowless = 1;
  spot.radius_m = 0.1f;
  spot.name = add_string(c, "torch");
  Light sun = point;
  sun.type = LightType::directional;
  sun.position_ws = sun.bounds_center_ws = {0, 0, 0};
  sun.range_m = sun.bounds_radius_m = sun.nearest_caster_m = 0;
  sun.intensity = 1000;
  sun.range_source = RangeSource::unbounded;
  sun.dynamic = sun.unclustered = 1;
  sun.group = 0;
  sun.node = 0;
  sun.name = add_string(c, "sun");
  c.lights = {point, spot, sun};
  c.cameras.push_back({{0, 1, 5}, 0.8f, {0, 0, -1}, 1.5f, {0, 1, 0}, 0.1f, none, add_string(c, "eye")});
}

/// Two leaves below a root, and for the banner a leaf alone. The root of the lights touches both their spheres.
void add_hierarchies(Contents& c) {
  c.batch_bvh = {{{-2, 0, -0.5f}, 3, {3, 1, 0}, none},
                 {{-2, 0, -0.5f}, 2, {-1, 1, 0}, 0 * 16 + 2},
                 {{2, 0, -0.5f}, 3, {3, 1, 0}, 2 * 16 + 2}};
  c.batch_bvh_items = {{0}, {2}, {1}, {3}};
  c.instance_bvh = {{{-2, 0, -0.5f}, 3, {3, 1, 0}, none},
                    {{-2, 0, -0.5f}, 2, {-1, 1, 0}, 0 * 16 + 1},
                    {{2, 0, -0.5f}, 3, {3, 1, 0}, 1 * 16 + 1}};
  c.instance_bvh_items = {{0}, {1}};
  c.triangle_bvh = {{{0, 0, -0.5f}, 3, {1, 1, 0}, none},
                    {{0, 0, 0}, 2, {1, 1, 0}, 0 * 16 + 1},
                    {{0, 0, -0.5f}, 3, {1, 1, 0}, 1 * 16 + 1},
                    {{0, 0, 0}, 4, {0.5f, 0.5f, 0}, 2 * 16 + 1}};
  c.triangle_bvh_items = {{0}, {1}, {2}};
  const float second_area = std::sqrt(1.5f) / 2;
  c.triangle_bvh_areas = {{0.5f + second_area}, {0.5f}, {second_area}, {0.125f}};
  const Light &bulb = c.lights[0], &torch = c.lights[1];
  const glm::vec3 across = bulb.bounds_center_ws - torch.bounds_center_ws;
  const float distance = glm::length(across);
  const float radius = (bulb.bounds_radius_m + torch.bounds_radius_m + distance) / 2 * 1.00001f;
  const glm::vec3 center = torch.bounds_center_ws + across * ((radius - torch.bounds_radius_m) / distance);
  c.light_bvh = {{center, radius, 3, none},
                 {bulb.bounds_center_ws, bulb.bounds_radius_m, 2, 0},
                 {torch.bounds_center_ws, torch.bounds_radius_m, 3, 1}};
}

/// Two cells, one behind the other: the first triangles lie in the front one, the masked ones are cut in two.
void add_voxels(Contents& c) {
  c.voxel_grid.push_back({{-2, 0, -0.5f}, VoxelMode::clip, {5, 1, 0.25f}, {1, 1, 2}, 4, 0});
  c.voxel_cells = {{0, 1}, {1, 3}};
  c.voxel_runs = {{none, 1, 0, 6}, {0, 0, 6, 3}, {1, 0, 9, 3}, {none, 1, 12, 12}};
  c.voxel_occupancy = {{3}};
  for (const float x : {-2.0f, 2.0f}) {  // corners 0, 2 and 3 of the triangle, then where two of its edges are cut
    c.voxel_vertices.push_back({{x, 0, 0}, {0, 0.5f}});
    c.voxel_vertices.push_back({{x + 1, 1, 0}, {0.5f, 0.5f}});
    c.voxel_vertices.push_back({{x, 1, -0.5f}, {0.75f, 0.5f}});
    c.voxel_vertices.push_back({{x + 0.5f, 1, -0.25f}, {0.625f, 0.5f}});
    c.voxel_vertices.push_back({{x, 0.5f, -0.25f}, {0.375f, 0.5f}});
  }
  c.voxel_indices = {{3}, {2}, {4}, {8}, {7}, {9}, {0}, {1}, {2}, {0}, {1}, {2},
                     {0}, {1}, {3}, {0}, {3}, {4}, {5}, {6}, {8}, {5}, {8}, {9}};
}

/// A pole that turns, and on it a cloth that is moved and stretched; both bend the banner.
void add_motion(Contents& c) {
  const glm::vec4 no_rotation = {0, 0, 0, 1};
  c.nodes.push_back({{{{1, 0, 0, 0.5f}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
                     {0.5f, 0, 0},
                     no_rotation,
                     {1, 1, 1},
                     none,
                     add_string(c, "pole")});
  c.nodes.push_back(
      {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, {0, 0, 0}, no_rotation, {1, 1, 1}, 0, add_string(c, "cloth")});
  const StringRef banner = add_string(c, "banner");
  c.instances.push_back({{{{1, 0, 0, 0.5f}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 1, 1, 0, 1, 0, banner});
  c.skins.push_back({0, 2, banner});
  c.joints = {{{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0}, {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 1}};
  for (uint32_t i = 0; i < 3; ++i) {
    const uint32_t first = 20000 * (i + 1);
    c.skin_vertices.push_back({{0u | 1u << 16, 0}, {first | (65535 - first) << 16, 0}});
  }
  c.animations.push_back({0, 3, 1.5f, 0, add_string(c, "wave")});
  c.animation_channels = {{0, AnimationPath::rotation, Interpolation::linear, 0, 2, 0, 8},
                          {1, AnimationPath::translation, Interpolation::step, 0, 2, 8, 6},
                          {1, AnimationPath::scale, Interpolation::cubic_spline, 2, 1, 14, 9}};
  c.animation_times = {{0}, {1.5f}, {0.75f}};
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f}) c.animation_values.push_back({value});
  for (const float value : {0.f, 0.f, 0.f, 0.f, 0.25f, 0.f}) c.animation_values.push_back({value});
  for (const float value : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f, 0.f, 0.f, 0.f}) c.animation_values.push_back({value});
}

}  // namespace

Contents sample() {
  Contents contents;
  add_vertices(contents);
  add_instances(contents);
  add_materials(contents);
  add_lights(contents);
  add_hierarchies(contents);
  add_voxels(contents);
  add_motion(contents);
  return contents;
}

Contents sheet(uint32_t side) {
  Contents c;
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const auto u = static_cast<float>(x), v = static_cast<float>(y);
      c.positions.push_back({{u / 64, v / 128, std::round(300 * std::sin(u / 9) * std::cos(v / 7)) / 1024}});
      c.vertex_attributes.push_back({x * 7919u, y * 104729u, {u / 16384, v / 16384}, {}, 0xffffffffu});
    }
  }
  for (uint32_t y = 0; y + 1 < side; ++y) {
    for (uint32_t x = 0; x + 1 < side; ++x) {
      const uint32_t i = y * side + x;
      const uint32_t turned =
          ((x * 2654435761u ^ y * 40503u) * 2246822519u) >> 31;  // which diagonal: without a pattern
      const uint32_t a = turned ? i + side : i, b = turned ? i : i + 1;
      const uint32_t across = turned ? i + side + 1 : i + side, d = turned ? i + 1 : i + side + 1;
      for (const uint32_t corner : {a, b, across, across, b, d}) c.indices.push_back({corner});
    }
  }
  c.bake_info.batch_triangles = 1;
  return c;
}

StringRef add_string(Contents& contents, std::string_view text) {
  const StringRef ref{static_cast<uint32_t>(contents.strings.size()), static_cast<uint32_t>(text.size())};
  for (const char c : text) contents.strings.push_back(static_cast<std::byte>(c));
  return ref;
}

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "chandelier-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> Folder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  return names;
}

std::vector<char> read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_file(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string open_error(const std::filesystem::path& path) {
  try {
    const File file(path);
    return {};
  } catch (const Error& error) {
    const std::string line = error.what(), start = path.string() + ": ";
    return line.starts_with(start) && line.find('\n') == std::string::npos ? line.substr(start.size())
                                                                           : "not one line with the path: " + line;
  }
}

}  // namespace chandelier::pack::test
