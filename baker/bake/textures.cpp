// SPDX-License-Identifier: Apache-2.0
// Materials and textures. An image that is used as colour and as data gets one request for each use.
#include "textures.h"

#include <map>
#include <tuple>
#include <utility>

#include "../error.h"

namespace chandelier::baker {
namespace {

pack::Wrap record_of(Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return pack::Wrap::clamp_to_edge;
  return wrap == Wrap::repeat ? pack::Wrap::repeat : pack::Wrap::mirrored_repeat;
}

pack::Filter record_of(Filter filter) {
  return filter == Filter::nearest ? pack::Filter::nearest : pack::Filter::linear;
}

class Textures {
 public:
  Textures(const Scene& scene, pack::Contents& pack) : scene_(scene), pack_(pack) {}

  uint32_t use(const TextureUse& from, ImageUse use, float alpha_cutoff) {
    const Texture& in = scene_.textures[from.texture];
    const uint32_t image = request({in.image, use, alpha_cutoff});
    const auto [it, added] = textures_.try_emplace({from.texture, image, from.uv_transform}, 0);
    if (added) {
      it->second = fit_u32(pack_.textures.size(), "textures");
      pack_.textures.push_back({.uv_transform = from.uv_transform,
                                .image = image,
                                .wrap_u = record_of(in.wrap_u),
                                .wrap_v = record_of(in.wrap_v),
                                .mag_filter = record_of(in.mag_filter),
                                .min_filter = record_of(in.min_filter)});
    }
    return it->second;
  }

  std::vector<ImageRequest> requests;

 private:
  struct Key {
    uint32_t texture, request;
    UvTransform uv_transform;

    bool operator<(const Key& other) const {
      const auto numbers = [](const Key& key) {
        const glm::vec3 &u = key.uv_transform[0], &v = key.uv_transform[1];
        return std::tuple(key.texture, key.request, u.x, u.y, u.z, v.x, v.y, v.z);
      };
      return numbers(*this) < numbers(other);
    }
  };

  uint32_t request(const ImageRequest& wanted) {
    const auto [it, added] = requests_.try_emplace(wanted, 0);
    if (added) {
      it->second = fit_u32(requests.size(), "images");
      requests.push_back(wanted);
    }
    return it->second;
  }

  const Scene& scene_;
  pack::Contents& pack_;
  std::map<Key, uint32_t> textures_;
  std::map<ImageRequest, uint32_t> requests_;
};

/// The smallest visible alpha of the base colour's texture; 0 if the texture does not decide it. Vertex colours are
/// ignored.
float texture_cutoff(const Material& material) {
  if (!material.masked || !(material.base_color_factor.a > 0)) return 0;
  const float cutoff = material.alpha_cutoff / material.base_color_factor.a;
  return cutoff > 0 && cutoff <= 1 ? cutoff : 0;
}

void add_maps(const Material& material, Textures& textures, pack::Material& out) {
  const float cutoff = texture_cutoff(material);
  const struct {
    const TextureUse& from;
    uint32_t& to;
    ImageUse use;
  } maps[] = {{material.base_color, out.base_color_texture, material.masked ? ImageUse::masked_color : ImageUse::color},
              {material.metallic_roughness, out.metallic_roughness_texture, ImageUse::data},
              {material.normal, out.normal_texture, ImageUse::normal},
              {material.occlusion, out.occlusion_texture, ImageUse::data},
              {material.emissive_map, out.emissive_texture, ImageUse::color}};
  for (uint32_t i = 0; i < 5; ++i) {
    if (maps[i].from.texture == no_index) continue;
    maps[i].to = textures.use(maps[i].from, maps[i].use, i == 0 ? cutoff : 0);
    out.uv1_mask |= uint32_t{maps[i].from.uv1} << i;
  }
}

pack::Material record_of(const Material& material, Strings& strings) {
  pack::Material out;
  out.base_color_factor = material.base_color_factor;
  out.emissive = material.emissive;
  out.metallic_factor = material.metallic_factor;
  out.roughness_factor = material.roughness_factor;
  out.alpha_cutoff = material.alpha_cutoff;
  out.normal_scale = material.normal_scale;
  out.occlusion_strength = material.occlusion_strength;
  out.alpha_mode = material.masked ? pack::AlphaMode::mask : pack::AlphaMode::opaque;
  out.double_sided = material.double_sided;
  out.unlit = material.unlit;
  out.shadowless = material.shadowless;
  out.transmission_factor = material.transmission_factor;
  out.name = strings.add(material.name);
  return out;
}

}  // namespace

std::vector<ImageRequest> make_materials(const Scene& scene, bool textures, Strings& strings, pack::Contents& pack) {
  Textures used(scene, pack);
  for (const Material& material : scene.materials) {
    pack::Material out = record_of(material, strings);
    if (textures) {
      add_maps(material, used, out);
    } else if (material.emissive_map.texture != no_index) {
      out.emissive = glm::vec3(0);
    }
    pack.materials.push_back(out);
  }
  return std::move(used.requests);
}

}  // namespace chandelier::baker
