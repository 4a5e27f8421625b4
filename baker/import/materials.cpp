// SPDX-License-Identifier: Apache-2.0
// Metallic-roughness materials, samplers, image bytes.
#include "materials.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

constexpr double kMostEmissive = 1e12;  // a pack's limit

Wrap wrap_of(int gltf_wrap, const std::string& where) {
  switch (gltf_wrap) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp_to_edge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirrored_repeat;
    default:
      fail(where, "is no wrap mode (" + std::to_string(gltf_wrap) + ")");
  }
}

/// -1 is absent: linear. The mipmap choice has no answer in a pack: all levels are there.
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
      fail(where, "is no filter (" + std::to_string(gltf_filter) + ")");
  }
}

/// KHR_materials_emissive_strength. From the JSON: tinygltf cuts an extension's integers to 32 bits.
double emissive_strength(const Json& material) {
  static const Json::json_pointer kPath("/extensions/KHR_materials_emissive_strength/emissiveStrength");
  return material.value(kPath, 1.0);
}

}  // namespace

std::uint32_t Materials::use(int material) {
  const auto [it, added] = materials_.try_emplace(material, 0);
  if (added) it->second = add_material(material);
  return it->second;
}

std::uint32_t Materials::add_material(int index) {
  Material out;
  if (index >= 0) {
    const tinygltf::Material& in = gltf_.model.materials[static_cast<std::size_t>(index)];
    const std::string here = place(gltf_.json, "materials", static_cast<std::size_t>(index));
    const std::string where = gltf_.file + ": " + here;
    const tinygltf::PbrMetallicRoughness& pbr = in.pbrMetallicRoughness;
    out.name = in.name;
    for (int c = 0; c < 4; ++c) out.base_color_factor[c] = static_cast<float>(pbr.baseColorFactor[c]);
    const double strength = emissive_strength(gltf_.json["materials"][static_cast<std::size_t>(index)]);
    for (int c = 0; c < 3; ++c) out.emissive[c] = static_cast<float>(in.emissiveFactor[c] * strength);
    for (int c = 0; c < 3; ++c) {
      if (!(out.emissive[c] <= kMostEmissive)) {
        fail(where + ", emissiveFactor", "times emissiveStrength is above " + to_text(kMostEmissive) + " (" +
                                             to_text(in.emissiveFactor[c] * strength) + ")");
      }
    }
    out.metallic_factor = static_cast<float>(pbr.metallicFactor);
    out.roughness_factor = static_cast<float>(pbr.roughnessFactor);
    out.normal_scale = static_cast<float>(in.normalTexture.scale);
    out.occlusion_strength = std::clamp(static_cast<float>(in.occlusionTexture.strength), 0.0f, 1.0f);
    out.double_sided = in.doubleSided;
    const auto use = [&](const auto& info, const char* what) {
      return use_texture(info.index, info.texCoord, info.extensions, here + ", " + what);
    };
    out.base_color = use(pbr.baseColorTexture, "baseColorTexture");
    out.metallic_roughness = use(pbr.metallicRoughnessTexture, "metallicRoughnessTexture");
    out.normal = use(in.normalTexture, "normalTexture");
    out.occlusion = use(in.occlusionTexture, "occlusionTexture");
    out.emissive_map = use(in.emissiveTexture, "emissiveTexture");
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

TextureUse Materials::use_texture(int texture, int tex_coord, const tinygltf::ExtensionMap& extensions,
                                  const std::string& where) {
  if (texture < 0) return {};
  if (extensions.contains("KHR_texture_transform")) {
    warnings_.add(gltf_.file, where, "KHR_texture_transform is ignored");
  }
  if (gltf_.model.textures[static_cast<std::size_t>(texture)].source < 0) {
    warnings_.add(gltf_.file, where, "texture has no PNG or JPEG image and is left out");
    return {};
  }
  if (tex_coord > 1) {
    warnings_.add(gltf_.file, where, "asks for a texture coordinate set above TEXCOORD_1 and is left out");
    return {};
  }
  const auto [it, added] = textures_.try_emplace(texture, 0);
  if (added) it->second = add_texture(texture);
  return {it->second, tex_coord == 1};
}

std::uint32_t Materials::add_texture(int index) {
  const tinygltf::Texture& in = gltf_.model.textures[static_cast<std::size_t>(index)];
  Texture out;
  out.image = use_image(in.source);
  if (in.sampler >= 0) {
    const auto number = static_cast<std::size_t>(in.sampler);
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

std::uint32_t Materials::use_image(int index) {
  const auto [it, added] = images_.try_emplace(index, 0);
  if (!added) return it->second;
  const auto number = static_cast<std::size_t>(index);
  const Json& in = gltf_.json["images"][number];
  EncodedImage out;
  out.where = gltf_.file + ": " + place(gltf_.json, "images", number);
  out.name = in.value("name", "");
  if (in.contains("uri")) {
    const std::string uri = in["uri"].get<std::string>();
    const bool embedded = uri.rfind("data:", 0) == 0;
    if (out.name.empty() && !embedded) out.name = uri;
    if (!embedded) out.where += " (" + shortened(uri, 80) + ")";
    out.bytes = read_uri(gltf_, uri, out.where);
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
