// SPDX-License-Identifier: Apache-2.0
// Metallic-roughness materials, samplers, image bytes.
#include "materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "../specular_glossiness.h"
#include "extras.h"

namespace chandelier::baker {
namespace {

constexpr double most_emissive = 1e12;  // a pack's limit

Wrap wrap_of(int gltf_wrap, const std::string& where) {
  switch (gltf_wrap) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp_to_edge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirrored_repeat;
    default:
      fail(where, "is not a wrap mode (" + std::to_string(gltf_wrap) + ")");
  }
}

/// -1 means absent, so linear. The choice of mipmaps is ignored, since a pack has all levels.
Filter filter_of(int gltf_filter, const std::string& where) {
  switch (gltf_filter) {
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
      return Filter::nearest;
    case -1:
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR:
      return Filter::linear;
    default:
      fail(where, "is not a filter (" + std::to_string(gltf_filter) + ")");
  }
}

/// KHR_materials_emissive_strength. From the JSON: tinygltf cuts an extension's integers to 32 bits.
double emissive_strength(const Json& material) {
  static const Json::json_pointer pointer("/extensions/KHR_materials_emissive_strength/emissiveStrength");
  return material.value(pointer, 1.0);
}

/// KHR_texture_transform: translation · rotation · scale, where the rotation goes counter-clockwise as v points down.
UvTransform uv_transform(const Json& json) {
  const auto offset = json.value("offset", std::array<double, 2>{0, 0});
  const auto scale = json.value("scale", std::array<double, 2>{1, 1});
  const double angle = json.value("rotation", 0.0), c = std::cos(angle), s = std::sin(angle);
  return {glm::vec3(c * scale[0], s * scale[1], offset[0]), glm::vec3(-s * scale[0], c * scale[1], offset[1])};
}

/// An image of KHR_texture_basisu, which is not decoded.
bool is_ktx2(const std::vector<uint8_t>& bytes) {
  constexpr std::string_view magic = "\xABKTX 20";
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

uint32_t Materials::use(int material) {
  const auto [it, added] = materials_.try_emplace(material, 0);
  if (added) it->second = add_material(material);
  return it->second;
}

uint32_t Materials::add_material(int index) {
  Material out;
  if (index >= 0) {
    const tinygltf::Material& in = gltf_.model.materials[static_cast<size_t>(index)];
    const std::string here = place(gltf_.json, "materials", static_cast<size_t>(index));
    const std::string where = gltf_.file + ": " + here;
    const tinygltf::PbrMetallicRoughness& pbr = in.pbrMetallicRoughness;
    out.name = in.name;
    out.where = where;
    for (int c = 0; c < 4; ++c) out.base_color_factor[c] = static_cast<float>(pbr.baseColorFactor[c]);
    const double strength = emissive_strength(gltf_.json["materials"][static_cast<size_t>(index)]);
    for (int c = 0; c < 3; ++c) out.emissive[c] = static_cast<float>(in.emissiveFactor[c] * strength);
    for (int c = 0; c < 3; ++c) {
      if (!(out.emissive[c] <= most_emissive)) {
        fail(where + ", emissiveFactor", "times emissiveStrength is above " + to_text(most_emissive) + " (" +
                                             to_text(in.emissiveFactor[c] * strength) + ")");
      }
    }
    out.metallic_factor = static_cast<float>(pbr.metallicFactor);
    out.roughness_factor = static_cast<float>(pbr.roughnessFactor);
    out.normal_scale = static_cast<float>(in.normalTexture.scale);
    out.occlusion_strength = std::clamp(static_cast<float>(in.occlusionTexture.strength), 0.0f, 1.0f);
    out.double_sided = in.doubleSided;
    const Json& json = gltf_.json["materials"][static_cast<size_t>(index)];
    out.unlit = json.contains(Json::json_pointer("/extensions/KHR_materials_unlit"));
    static const Json::json_pointer glossy_pointer("/extensions/KHR_materials_pbrSpecularGlossiness");
    if (json.contains(glossy_pointer)) {  // the extension takes precedence if a material has both
      convert(json[glossy_pointer], in.alphaMode == "MASK", here, out);
    } else {
      const Json metallic_roughness = json.value("pbrMetallicRoughness", Json::object());
      out.base_color = use_texture(metallic_roughness, "baseColorTexture", in.alphaMode == "MASK", here);
      out.metallic_roughness = use_texture(metallic_roughness, "metallicRoughnessTexture", false, here);
    }
    out.normal = use_texture(json, "normalTexture", false, here);
    out.occlusion = use_texture(json, "occlusionTexture", false, here);
    out.emissive_map = use_texture(json, "emissiveTexture", false, here);
    read_transmission(json, here, out);
    out.shadow = shadow_of_material(gltf_, static_cast<size_t>(index), warnings_);
    out.shadowless = !out.shadow.value_or(true);
    // Without its map, which may be black nearly everywhere, the whole surface would glow.
    if (json.contains("emissiveTexture") && out.emissive_map.texture == no_index) out.emissive = glm::vec3(0);
    if (in.alphaMode != "OPAQUE" && in.alphaMode != "MASK" && in.alphaMode != "BLEND") {
      fail(where + ", alphaMode", "is not OPAQUE, MASK or BLEND (" + shortened(in.alphaMode, 40) + ")");
    }
    out.masked = in.alphaMode != "OPAQUE";
    if (in.alphaMode == "MASK") out.alpha_cutoff = static_cast<float>(in.alphaCutoff);
    if (in.alphaMode == "BLEND") ++blended_;
  }
  scene_.materials.push_back(std::move(out));
  return fit_u32(scene_.materials.size() - 1, "materials");
}

/// KHR_materials_transmission. Without its map, the whole surface would let light through.
void Materials::read_transmission(const Json& material, const std::string& here, Material& out) {
  static const Json::json_pointer pointer("/extensions/KHR_materials_transmission");
  if (!material.contains(pointer)) return;
  const Json& transmission = material[pointer];
  out.transmission_factor = transmission.value("transmissionFactor", 0.0f);
  if (out.transmission_factor == 0) return;
  out.transmission_map = use_texture(transmission, "transmissionTexture", false, here);
  if (transmission.contains("transmissionTexture") && out.transmission_map.texture == no_index) {
    out.transmission_factor = 0;
  }
}

TextureUse Materials::use_texture(const Json& owner, const char* key, bool alpha, const std::string& here) {
  const auto info = owner.find(key);
  if (info == owner.end()) return {};
  const std::string where = here + ", " + key;
  const auto number = (*info)["index"].get<size_t>();
  const auto image = image_of(gltf_.json["textures"][number], alpha, where);
  if (!image) return {};
  static const Json::json_pointer transform_pointer("/extensions/KHR_texture_transform");
  const Json transform = info->contains(transform_pointer) ? (*info)[transform_pointer] : Json::object();
  const int coordinates = transform.value("texCoord", info->value("texCoord", 0));
  if (coordinates > 1) {
    warnings_.add(gltf_.file, where, "asks for a texture coordinate set above TEXCOORD_1 and is left out");
    return {};
  }
  const auto [it, added] = textures_.try_emplace(number, 0);
  if (added) it->second = add_texture(number, *image);
  return {it->second, coordinates == 1, uv_transform(transform)};
}

std::optional<uint32_t> Materials::image_of(const Json& texture, bool alpha, const std::string& where) {
  static const Json::json_pointer webp("/extensions/EXT_texture_webp/source"), ktx2("/extensions/KHR_texture_basisu");
  bool lacking = texture.contains(ktx2);  // an image that is not decoded is left out
  for (const Json& source : {texture.value("source", Json()), texture.value(webp, Json())}) {
    if (source.is_null()) continue;
    const uint32_t image = use_image(source.get<size_t>());
    if (!is_ktx2(scene_.images[image].bytes)) return image;
    lacking = true;
  }
  const std::string what =
      lacking ? "has no PNG, JPEG or WebP image but only that of KHR_texture_basisu" : "texture has no image";
  if (alpha && lacking) fail(gltf_.file + ": " + where, what + ", but shadows need its alpha");
  warnings_.add(gltf_.file, where, what + " and is left out");
  return std::nullopt;
}

void Materials::convert(const Json& glossy, bool alpha, const std::string& here, Material& out) {
  ++converted_;
  const std::string where = here + ", KHR_materials_pbrSpecularGlossiness";
  const auto diffuse_factor = glossy.value("diffuseFactor", std::array<float, 4>{1, 1, 1, 1});
  const auto specular_factor = glossy.value("specularFactor", std::array<float, 3>{1, 1, 1});
  SpecularGlossiness factors;
  factors.diffuse_factor = {diffuse_factor[0], diffuse_factor[1], diffuse_factor[2]};
  factors.specular_factor = {specular_factor[0], specular_factor[1], specular_factor[2]};
  factors.glossiness_factor = glossy.value("glossinessFactor", 1.0f);
  TextureUse diffuse = use_texture(glossy, "diffuseTexture", alpha, where);
  TextureUse mirror = use_texture(glossy, "specularGlossinessTexture", false, where);
  const bool colored = diffuse.texture != no_index, mirrored = mirror.texture != no_index;
  if (!mirrored && glossy.contains("specularGlossinessTexture")) {  // without it the whole surface would be a mirror
    factors.specular_factor = glm::min(factors.specular_factor, glm::vec3(dielectric));
    factors.glossiness_factor = 0;
  }
  const bool alike = diffuse.uv1 == mirror.uv1 && diffuse.uv_transform == mirror.uv_transform;
  const MetallicColor plain = metallic_color(factors.diffuse_factor, factors.specular_factor);
  out.base_color_factor = {plain.base_color, diffuse_factor[3]};
  out.metallic_factor = plain.metallic;
  out.roughness_factor = 1 - factors.glossiness_factor;
  if (!mirrored && (!colored || is_dielectric(factors.specular_factor))) {  // the conversion then only changes factors
    out.base_color = diffuse;
    return;
  }
  if (mirrored) factors.specular_glossiness = scene_.textures[mirror.texture].image;
  if (colored && mirrored && !alike) {
    warnings_.add(gltf_.file, where,
                  "its two textures are mapped differently, so all of it is treated as non-metallic");
    out.base_color = diffuse;
    out.base_color_factor = {factors.diffuse_factor, diffuse_factor[3]};
    out.metallic_factor = 0;
  } else {
    if (colored) factors.diffuse = scene_.textures[diffuse.texture].image;
    out.base_color = colored ? diffuse : mirror;
    out.base_color.texture = use_converted(factors, out.base_color);
    out.base_color_factor = {1, 1, 1, diffuse_factor[3]};
    out.metallic_factor = 1;
  }
  out.metallic_roughness = mirrored ? mirror : diffuse;
  out.metallic_roughness.texture = use_converted(factors, out.metallic_roughness);
  out.roughness_factor = 1;
}

uint32_t Materials::use_converted(const SpecularGlossiness& factors, const TextureUse& like) {
  const auto known = std::find_if(converted_images_.begin(), converted_images_.end(),
                                  [&](const auto& each) { return each.first == factors; });
  uint32_t image = known == converted_images_.end() ? no_index : known->second;
  if (image == no_index) {
    const uint32_t from = factors.diffuse == no_index ? factors.specular_glossiness : factors.diffuse;
    const EncodedImage& source = scene_.images[from];
    scene_.images.push_back({source.name, source.where, {}, source.file, factors});
    image = fit_u32(scene_.images.size() - 1, "images");
    converted_images_.emplace_back(factors, image);
  }
  Texture texture = scene_.textures[like.texture];
  texture.image = image;
  scene_.textures.push_back(texture);
  return fit_u32(scene_.textures.size() - 1, "textures");
}

uint32_t Materials::add_texture(size_t index, uint32_t image) {
  const tinygltf::Texture& in = gltf_.model.textures[index];
  Texture out;
  out.image = image;
  if (in.sampler >= 0) {
    const auto number = static_cast<size_t>(in.sampler);
    const std::string where = gltf_.file + ": " + place(gltf_.json, "samplers", number);
    const tinygltf::Sampler& sampler = gltf_.model.samplers[number];
    out.wrap_u = wrap_of(sampler.wrapS, where + ", wrapS");
    out.wrap_v = wrap_of(sampler.wrapT, where + ", wrapT");
    out.mag_filter = filter_of(sampler.magFilter, where + ", magFilter");
    out.min_filter = filter_of(sampler.minFilter, where + ", minFilter");
  }
  scene_.textures.push_back(out);
  return fit_u32(scene_.textures.size() - 1, "textures");
}

uint32_t Materials::use_image(size_t number) {
  const auto [it, added] = images_.try_emplace(number, 0);
  if (!added) return it->second;
  const Json& in = gltf_.json["images"][number];
  EncodedImage out;
  std::string here = place(gltf_.json, "images", number);
  out.file = gltf_.file;
  out.where = gltf_.file + ": " + here;
  out.name = in.value("name", "");
  if (in.contains("uri")) {
    const std::string uri = in["uri"].get<std::string>();
    const bool embedded = uri.rfind("data:", 0) == 0;
    if (out.name.empty() && !embedded) out.name = uri;
    if (!embedded) here += " (" + shortened(uri, 80) + ")";
    out.where = gltf_.file + ": " + here;
    const Bytes file = read_uri(gltf_, uri, here, warnings_);
    out.bytes.assign(file.bytes.begin(), file.bytes.end());
  } else if (in.contains("bufferView")) {
    const auto bytes = view_bytes(gltf_, in["bufferView"].get<int>(), out.where);
    out.bytes.assign(bytes.begin(), bytes.end());
  } else {
    fail(out.where, "has neither uri nor bufferView");
  }
  scene_.images.push_back(std::move(out));
  it->second = fit_u32(scene_.images.size() - 1, "images");
  return it->second;
}

void Materials::warn() const {
  if (blended_ == 0) return;
  warnings_.add(gltf_.file, "materials",
                std::to_string(blended_) + (blended_ == 1 ? " material" : " materials") +
                    " with alphaMode BLEND baked as MASK with cutoff 0.5");
}

}  // namespace chandelier::baker
