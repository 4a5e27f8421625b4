// SPDX-License-Identifier: Apache-2.0
// Materials and textures. An image that serves as colour here and as data there is stored once as each.
#include "textures.h"

#include <map>
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

  std::uint32_t use(std::uint32_t texture, ImageUse use) {
    const auto [it, added] = textures_.try_emplace({texture, use}, 0);
    if (added) {
      const Texture& in = scene_.textures[texture];
      it->second = fit_u32(pack_.textures.size(), "textures");
      pack_.textures.push_back({.uv_transform = {{{1, 0, 0}, {0, 1, 0}}},
                                .image = request(in.image, use),
                                .wrap_u = record_of(in.wrap_u),
                                .wrap_v = record_of(in.wrap_v),
                                .mag_filter = record_of(in.mag_filter),
                                .min_filter = record_of(in.min_filter)});
    }
    return it->second;
  }

  std::vector<ImageRequest> requests;

 private:
  std::uint32_t request(std::uint32_t image, ImageUse use) {
    const auto [it, added] = images_.try_emplace({image, use}, 0);
    if (added) {
      it->second = fit_u32(requests.size(), "images");
      requests.push_back({image, use});
    }
    return it->second;
  }

  const Scene& scene_;
  pack::Contents& pack_;
  std::map<std::pair<std::uint32_t, ImageUse>, std::uint32_t> textures_, images_;
};

pack::Material record_of(const Material& material, Textures& textures, Strings& strings) {
  pack::Material out;
  out.base_color_factor = material.base_color_factor;
  out.emissive = material.emissive;
  out.metallic_factor = material.metallic_factor;
  out.roughness_factor = material.roughness_factor;
  out.alpha_cutoff = material.alpha_cutoff;
  out.normal_scale = material.normal_scale;
  out.occlusion_strength = material.occlusion_strength;
  const struct {
    const TextureUse& from;
    std::uint32_t& to;
    ImageUse use;
  } maps[] = {{material.base_color, out.base_color_texture, ImageUse::color},
              {material.metallic_roughness, out.metallic_roughness_texture, ImageUse::data},
              {material.normal, out.normal_texture, ImageUse::normal},
              {material.occlusion, out.occlusion_texture, ImageUse::data},
              {material.emissive_map, out.emissive_texture, ImageUse::color}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    if (maps[i].from.texture == kNone) continue;
    maps[i].to = textures.use(maps[i].from.texture, maps[i].use);
    out.uv1_mask |= std::uint32_t{maps[i].from.uv1} << i;
  }
  out.alpha_mode = material.masked ? pack::AlphaMode::mask : pack::AlphaMode::opaque;
  out.double_sided = material.double_sided;
  out.name = strings.add(material.name);
  return out;
}

}  // namespace

std::vector<ImageRequest> make_materials(const Scene& scene, Strings& strings, pack::Contents& pack) {
  Textures textures(scene, pack);
  for (const Material& material : scene.materials) pack.materials.push_back(record_of(material, textures, strings));
  return std::move(textures.requests);
}

}  // namespace chandelier::baker
