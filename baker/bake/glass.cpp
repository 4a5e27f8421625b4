// SPDX-License-Identifier: Apache-2.0
// A shadow map knows only lit and dark, so a surface casts a full shadow or none: none if it lets half of the light or
// more through. KHR_materials_transmission gives that share: factor · texture (red), of the non-metallic part (1 -
// factor · texture (blue)).
#include "glass.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "decode_scene.h"

namespace chandelier::baker {
namespace {

constexpr float least = 0.5f;  // share of light that glass lets through
constexpr uint32_t rows = 4;   // a triangle is sampled at the centre of each of its 16 parts

int64_t wrapped(int64_t texel, int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<int64_t>(texel, 0, size - 1);
  const int64_t period = wrap == Wrap::repeat ? size : 2 * size;
  const int64_t at = (texel % period + period) % period;
  return at < size ? at : period - 1 - at;
}

/// One channel of an image.
struct Plane {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> values;
  std::vector<std::string> damage;  // of the files that the image is made of
};

/// Decodes each image once for each channel that is asked for, however many materials ask.
class Planes {
 public:
  const Plane& of(const Scene& scene, uint32_t image, size_t channel) {
    const auto [it, added] = planes_.try_emplace({image, channel});
    Plane& plane = it->second;
    if (!added) return plane;
    SceneTexels decoded = decode_image(scene, image);
    const Texels& texels = decoded.as(ImageUse::data);
    plane = {texels.width, texels.height, {}, std::move(decoded.damage)};
    plane.values.resize(texels.rgba.size() / 4);
    for (size_t i = 0; i < plane.values.size(); ++i) plane.values[i] = texels.rgba[4 * i + channel];
    return plane;
  }

 private:
  std::map<std::pair<uint32_t, size_t>, Plane> planes_;
};

/// One channel of a texture; 1 everywhere if there is no texture.
class Channel {
 public:
  Channel(const Scene& scene, const TextureUse& use, size_t channel, Planes& planes) : use_(use) {
    if (use.texture == no_index) return;
    texture_ = scene.textures[use.texture];
    plane_ = &planes.of(scene, texture_.image, channel);
  }

  /// The damage of the texture's files. There must be a texture.
  const std::vector<std::string>& damage() const { return plane_->damage; }

  /// At the nearest texel: only means over triangles are needed.
  float at(const glm::vec2& uv0, const glm::vec2& uv1) const {
    if (!plane_) return 1;
    const glm::vec3 uv(use_.uv1 ? uv1 : uv0, 1);
    const int64_t x = texel(glm::dot(use_.uv_transform[0], uv), plane_->width, texture_.wrap_u);
    const int64_t y = texel(glm::dot(use_.uv_transform[1], uv), plane_->height, texture_.wrap_v);
    return static_cast<float>(plane_->values[static_cast<size_t>(y * plane_->width + x)]) / 255;
  }

 private:
  static int64_t texel(float coordinate, uint32_t size, Wrap wrap) {
    constexpr double farthest = 1e15;  // beyond this, a float has no fractions of a texel
    const double at = std::floor(double{coordinate} * size);
    return wrapped(static_cast<int64_t>(std::clamp(at, -farthest, farthest)), size, wrap);
  }

  TextureUse use_;
  Texture texture_;
  const Plane* plane_ = nullptr;
};

/// How much light a material lets through.
class Transmission {
 public:
  Transmission(const Scene& scene, const Material& material, Planes& planes)
      : factor_(material.transmission_factor),
        metallic_(material.metallic_factor),
        through_(scene, material.transmission_map, 0, planes),
        metal_(scene, material.metallic_factor > 0 ? material.metallic_roughness : TextureUse{}, 2, planes) {}

  /// The damage of the transmission map; the other map is checked with all images.
  const std::vector<std::string>& damage() const { return through_.damage(); }

  /// The mean over a triangle.
  float of(const std::array<const Vertex*, 3>& corners) const {
    float sum = 0;
    for (uint32_t row = 0; row < rows; ++row) {
      for (uint32_t i = 0; i < 2 * row + 1; ++i) {
        const float down = (static_cast<float>(row) + (i % 2 ? 1.0f : 2.0f) / 3) / rows;
        const float along = (static_cast<float>(i / 2) + (i % 2 ? 2.0f : 1.0f) / 3) / rows;
        sum += at(corners, down - along, along);
      }
    }
    return sum / (rows * rows);
  }

 private:
  float at(const std::array<const Vertex*, 3>& corners, float b, float c) const {
    const float a = 1 - b - c;
    const glm::vec2 uv0 = a * corners[0]->uv0 + b * corners[1]->uv0 + c * corners[2]->uv0;
    const glm::vec2 uv1 = a * corners[0]->uv1 + b * corners[1]->uv1 + c * corners[2]->uv1;
    return factor_ * through_.at(uv0, uv1) * (1 - metallic_ * metal_.at(uv0, uv1));
  }

  float factor_, metallic_;
  Channel through_, metal_;
};

/// For each triangle of a primitive, whether it is glass.
std::vector<uint8_t> glass_triangles(const Primitive& primitive, const Transmission& transmission) {
  std::vector<uint8_t> out(primitive.indices.size() / 3);
  tbb::parallel_for(size_t{0}, out.size(), [&](size_t i) {
    const auto corner = [&](size_t c) { return &primitive.vertices[primitive.indices[3 * i + c]]; };
    out[i] = transmission.of({corner(0), corner(1), corner(2)}) >= least;
  });
  return out;
}

/// The triangles that are glass, or those that are not, with the vertices that they need.
Primitive part_of(const Primitive& whole, const std::vector<uint8_t>& is_glass, bool glass) {
  Primitive out;
  out.material = whole.material;
  out.needs_normals = whole.needs_normals;
  out.needs_tangents = whole.needs_tangents;
  out.tangents_from_uv1 = whole.tangents_from_uv1;
  std::vector<uint32_t> numbers(whole.vertices.size(), no_index);
  for (size_t i = 0; i < 3 * is_glass.size(); ++i) {
    if ((is_glass[i / 3] != 0) != glass) continue;
    uint32_t& number = numbers[whole.indices[i]];
    if (number == no_index) {
      number = static_cast<uint32_t>(out.vertices.size());
      out.vertices.push_back(whole.vertices[whole.indices[i]]);
      if (!whole.skin_vertices.empty()) out.skin_vertices.push_back(whole.skin_vertices[whole.indices[i]]);
    }
    out.indices.push_back(number);
  }
  return out;
}

/// Gives the glass among a material's triangles the material `glass`. Returns how many there are, and how many others.
std::array<uint64_t, 2> split(Scene& scene, uint32_t material, uint32_t glass, bool strict, Planes& planes,
                              Warnings& warnings) {
  const Transmission transmission(scene, scene.materials[material], planes);
  if (const uint32_t texture = scene.materials[material].transmission_map.texture; texture != no_index) {
    const Texture& map = scene.textures[texture];
    report_damage(scene, map.image, transmission.damage(), strict, warnings);
  }
  std::array<uint64_t, 2> counts{};
  for (Mesh& mesh : scene.meshes) {
    const size_t primitives = mesh.primitives.size();
    for (size_t p = 0; p < primitives; ++p) {
      if (mesh.primitives[p].material != material) continue;
      const std::vector<uint8_t> is_glass = glass_triangles(mesh.primitives[p], transmission);
      const auto through = static_cast<uint64_t>(std::count(is_glass.begin(), is_glass.end(), 1));
      counts[0] += through;
      counts[1] += is_glass.size() - through;
      if (through == 0) continue;
      if (through < is_glass.size()) {
        Primitive rest = part_of(mesh.primitives[p], is_glass, false);
        mesh.primitives[p] = part_of(mesh.primitives[p], is_glass, true);
        mesh.primitives.push_back(std::move(rest));
      }
      mesh.primitives[p].material = glass;
    }
  }
  return counts;
}

bool has_maps(const Material& material) {
  const bool may_be_metal = material.metallic_factor > 0 && material.metallic_roughness.texture != no_index;
  return may_be_metal || material.transmission_map.texture != no_index;
}

/// Whether any of the material casts no shadow now.
bool find_glass_of(Scene& scene, uint32_t number, const ImageSettings& images, Planes& planes, Warnings& warnings) {
  Material& material = scene.materials[number];
  const bool textures = images.textures != TextureMode::none;
  // Without its map, which may be black nearly everywhere, the whole surface would let light through.
  if (!textures && material.transmission_map.texture != no_index) return false;
  if (!textures || !has_maps(material)) {
    material.shadowless = material.transmission_factor * (1 - material.metallic_factor) >= least;
    return material.shadowless;
  }
  const uint32_t glass = fit_u32(scene.materials.size(), "materials");
  const auto [through, others] = split(scene, number, glass, images.strict, planes, warnings);
  if (through == 0) return false;
  scene.materials.push_back(scene.materials[number]);
  scene.materials.back().shadowless = true;
  if (others > 0) return true;
  for (Mesh& mesh : scene.meshes) {  // the copied material is not needed
    for (Primitive& primitive : mesh.primitives) {
      if (primitive.material == glass) primitive.material = number;
    }
  }
  scene.materials.pop_back();
  scene.materials[number].shadowless = true;
  return true;
}

}  // namespace

void find_glass(Scene& scene, bool glass_shadows, const ImageSettings& images, PassReport& pass, Warnings& warnings) {
  uint64_t found = 0;
  Planes planes;
  const auto materials = static_cast<uint32_t>(glass_shadows ? 0 : scene.materials.size());
  for (uint32_t m = 0; m < materials; ++m) {
    const Material& material = scene.materials[m];
    if (material.shadow || material.transmission_factor < least) continue;
    const std::string name = material.name.empty() ? material.where : material.name;
    if (!find_glass_of(scene, m, images, planes, warnings)) continue;
    ++found;
    warnings.add("scene", "materials",
                 "light passes through them, so they cast no shadow (--glass-shadows gives them one)", name);
  }
  pass.count("materials", static_cast<double>(found));
}

}  // namespace chandelier::baker
