// SPDX-License-Identifier: Apache-2.0
// A small pack that has something in every section, and what tests do with files.
#include "pack_sample.h"

#include <stdlib.h>

#include <fstream>
#include <iterator>

#include "octahedral.h"

namespace chandelier::pack::test {
namespace {

void add_geometry(Contents& c) {
  c.positions = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, -0.5f}}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const float f = static_cast<float>(i);
    c.vertex_attributes.push_back({encode_normal({0, 0, 1}), encode_tangent({1, 0, 0, -1}), {0.25f * f, 0.5f}, {2.0f * f, -1}, 0xff804020u + i});
  }
  c.indices = {{0}, {1}, {2}, {0}, {2}, {3}};
  c.batches = {{{0, 0, 0}, 0, {1, 1, 0}, 3, {0, 0, -1}, 0.5f, {0, 0, 1}, 0, 1},
               {{0, 0, -0.5f}, 3, {1, 1, 0}, 3, {}, 1, {}, 1, 0}};
  c.meshes.push_back({.bounds_min_ls = {0, 0, -0.5f},
                      .first_batch = 0,
                      .bounds_max_ls = {1, 1, 0},
                      .batch_count = 2,
                      .first_vertex = 0,
                      .vertex_count = 4});
  const StringRef left = add_string(c, "left"), right = add_string(c, "right");
  c.instances.push_back({{{{1, 0, 0, -2}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0, 0, none, none, left});
  c.instances.push_back({{{{1, 0, 0, 2}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0, 0, none, none, right});
  c.batch_instances = {{{-2, 0, 0}, 0, {-1, 1, 0}, 0}, {{2, 0, 0}, 0, {3, 1, 0}, 1}, {{2, 0, -0.5f}, 1, {3, 1, 0}, 1}};
  c.bake_info.bounds_min_ws = {-2, 0, -0.5f};
  c.bake_info.bounds_max_ws = {3, 1, 0};
  c.bake_info.unique_triangles = 2;
  c.bake_info.instanced_triangles = 3;
  c.bake_info.batch_triangles = 100;
  c.bake_info.range_threshold_lx = 0.05f;
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
  leaf.double_sided = 1;
  leaf.name = add_string(c, "Blätter");
  c.materials = {stone, leaf};
  c.textures = {{{{{1, 0, 0}, {0, 1, 0}}}, 0, Wrap::repeat, Wrap::mirrored_repeat, Filter::linear, Filter::nearest},
                {{{{2, 0, 0.5f}, {0, 2, -0.25f}}}, 1, Wrap::clamp_to_edge, Wrap::repeat, Filter::linear, Filter::linear}};
  c.images.push_back({0, 44, 4, 2, 3, ImageFormat::rgba8_srgb, add_string(c, "bricks.png")});  // 4×2, 2×1, 1×1
  c.images.push_back({48, 4, 1, 1, 1, ImageFormat::rgba8_unorm, add_string(c, "flat")});
  for (int i = 0; i < 52; ++i) c.image_data.push_back(static_cast<std::byte>(i * 5));
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
  point.priority = 128;
  point.name = add_string(c, "bulb");
  Light spot = point;
  spot.type = LightType::spot;
  spot.direction_ws = {0, -1, 0};
  spot.inner_cone_cos = 0.9f;
  spot.outer_cone_cos = 0.5f;
  spot.range_m = 15.8f;
  spot.range_source = RangeSource::derived;
  spot.name = add_string(c, "torch");
  Light sun = point;
  sun.type = LightType::directional;
  sun.position_ws = {0, 0, 0};
  sun.range_m = 0;
  sun.intensity = 1000;
  sun.range_source = RangeSource::unbounded;
  sun.name = add_string(c, "sun");
  c.lights = {point, spot, sun};
  c.cameras.push_back({{0, 1, 5}, 0.8f, {0, 0, -1}, 1.5f, {0, 1, 0}, 0.1f, none, add_string(c, "eye")});
}

}  // namespace

Contents sample() {
  Contents contents;
  add_geometry(contents);
  add_materials(contents);
  add_lights(contents);
  return contents;
}

StringRef add_string(Contents& contents, std::string_view text) {
  const StringRef ref{static_cast<std::uint32_t>(contents.strings.size()), static_cast<std::uint32_t>(text.size())};
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
