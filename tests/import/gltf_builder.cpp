// SPDX-License-Identifier: Apache-2.0
// Makes small glTF files in tests.
#include "gltf_builder.h"

#include <unistd.h>

#include <fstream>

#include "import/import.h"

namespace chandelier::baker::test {

std::string base64(const std::vector<uint8_t>& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

int GltfBuilder::add_positions(const std::vector<float>& xyz) {
  const int accessor = add_floats(xyz, "VEC3", 3);
  glm::vec3 low(xyz.at(0), xyz.at(1), xyz.at(2)), high = low;
  for (size_t i = 0; i + 2 < xyz.size(); i += 3) {
    const glm::vec3 p(xyz[i], xyz[i + 1], xyz[i + 2]);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  json["accessors"][accessor]["min"] = {low.x, low.y, low.z};
  json["accessors"][accessor]["max"] = {high.x, high.y, high.z};
  return accessor;
}

std::string GltfBuilder::text() const {
  Json whole = json;
  if (!bytes.empty()) {
    whole["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  }
  if (fallback_bytes) {
    const Json fallback = {{"EXT_meshopt_compression", {{"fallback", true}}}};
    whole["buffers"].push_back({{"byteLength", fallback_bytes}, {"extensions", fallback}});
  }
  return whole.dump(1);
}

std::filesystem::path scratch_folder() {
  static const struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("chandelier-import-" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code error;
      std::filesystem::remove_all(path, error);
    }
  } folder;
  return folder.path;
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::filesystem::path GltfBuilder::save(const std::string& name) const {
  const std::filesystem::path path = scratch_folder() / (name + ".gltf");
  write_bytes(path, text());
  return path;
}

Scene GltfBuilder::import(Warnings* warnings) const {
  Scene scene;
  Warnings unread;
  import_gltf(save(), scene, warnings ? *warnings : unread);
  return scene;
}

pack::Contents GltfBuilder::bake(const BakeSettings& settings) const {
  return bake_scene(import(), settings);
}

pack::Contents bake_scene(Scene&& scene, const BakeSettings& settings) {
  Report report;
  Warnings warnings;
  pack::Contents pack = baker::bake(std::move(scene), settings, Progress(false), report, warnings);
  check(pack, report);
  return pack;
}

GltfBuilder one_triangle() {
  GltfBuilder gltf;
  const int positions = gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", gltf.add_indices({0, 1, 2})}});
  gltf.add_node({{"mesh", 0}, {"name", "triangle"}});
  return gltf;
}

std::string error_of(const std::filesystem::path& path) {
  try {
    Scene scene;
    Warnings warnings;
    import_gltf(path, scene, warnings);
    bake_scene(std::move(scene), {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string text_of(const pack::Contents& pack, const pack::StringRef& ref) {
  return {reinterpret_cast<const char*>(pack.strings.data()) + ref.offset_bytes, ref.size_bytes};
}

}  // namespace chandelier::baker::test
