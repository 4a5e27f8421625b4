// SPDX-License-Identifier: Apache-2.0
// KHR_materials_pbrSpecularGlossiness as metallic-roughness: the formula, texels, materials.
#include "specular_glossiness.h"

#include <gtest/gtest.h>

#include "bake/convert_specular.h"
#include "bake/decode_scene.h"
#include "encode_image.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

using Bytes = std::vector<uint8_t>;

/// What glTF's metallic-roughness model reflects: diffuse as the other model names it, and specular.
struct Reflected {
  glm::vec3 diffuse, specular;
};

Reflected reflected_by(const glm::vec3& base, float metallic) {
  Reflected out;
  out.specular = glm::mix(glm::vec3(0.04f), base, metallic);
  const float left = 1 - std::max({out.specular.r, out.specular.g, out.specular.b});
  out.diffuse = base * (0.96f * (1 - metallic) / std::max(left, 1e-6f));
  return out;
}

TEST(SpecularGlossiness, ComesBackFromWhatItsFormulaMakes) {
  for (const float value : {0.05f, 0.2f, 0.5f, 0.8f, 0.95f}) {
    for (const float metallic : {0.0f, 0.1f, 0.3f, 0.7f, 1.0f}) {
      const Reflected grey = reflected_by(glm::vec3(value), metallic);
      const MetallicColor back = metallic_color(grey.diffuse, grey.specular);
      EXPECT_NEAR(back.metallic, metallic, 1e-3) << value;
      EXPECT_NEAR(back.base_color.r, value, 1e-3) << metallic;
    }
  }
  for (const glm::vec3& color : {glm::vec3(0.9f, 0.5f, 0.1f), glm::vec3(0.1f, 0.2f, 0.8f)}) {
    for (const float metallic : {0.0f, 1.0f}) {
      const Reflected hued = reflected_by(color, metallic);
      const MetallicColor back = metallic_color(hued.diffuse, hued.specular);
      EXPECT_NEAR(back.metallic, metallic, 1e-3);
      EXPECT_LT(glm::length(back.base_color - color), 1e-3f);
    }
  }
}

TEST(SpecularGlossiness, StaysInRangeForAnyColours) {
  const float values[] = {0, 0.03f, 0.04f, 0.05f, 0.5f, 1};
  for (const float d : values) {
    for (const float s : values) {
      for (const glm::vec3& diffuse : {glm::vec3(d), glm::vec3(d, 0, 1)}) {
        const MetallicColor made = metallic_color(diffuse, glm::vec3(s, s, 0));
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(made.base_color[c] >= 0 && made.base_color[c] <= 1);
        EXPECT_TRUE(made.metallic >= 0 && made.metallic <= 1);
      }
    }
  }
}

TEST(SpecularGlossiness, TexelsAreConvertedOneByOne) {
  // Left a plain surface, right gold; glossiness 0.2 and 0.8, which a factor halves.
  const Texels diffuse{2, 1, {188, 188, 188, 255, 0, 0, 0, 100}};
  const Texels glossy{2, 1, {56, 56, 56, 51, 255, 200, 100, 204}};
  SpecularGlossiness factors;
  factors.glossiness_factor = 0.5f;
  const MetallicTexels made = convert_texels(factors, &diffuse, &glossy);
  EXPECT_NEAR(made.base_color.rgba[0], 188, 2);
  EXPECT_EQ(made.base_color.rgba[3], 255);
  EXPECT_EQ(made.base_color.rgba[4], 255);
  EXPECT_EQ(made.base_color.rgba[5], 200);
  EXPECT_EQ(made.base_color.rgba[6], 100);
  EXPECT_EQ(made.base_color.rgba[7], 100);
  EXPECT_EQ(made.metallic_roughness.rgba[1], 230);  // 1 - 0.1
  EXPECT_LT(made.metallic_roughness.rgba[2], 3);
  EXPECT_EQ(made.metallic_roughness.rgba[5], 153);  // 1 - 0.4
  EXPECT_EQ(made.metallic_roughness.rgba[6], 255);
}

TEST(SpecularGlossiness, TheSmallerImageIsInterpolated) {
  Texels diffuse{4, 2, Bytes(32, 0)};
  for (size_t i = 0; i < 8; ++i) diffuse.rgba[4 * i + 3] = static_cast<uint8_t>(30 * i);
  const Texels glossy{2, 1, {0, 0, 0, 0, 0, 0, 0, 200}};
  const MetallicTexels made = convert_texels({}, &diffuse, &glossy);
  ASSERT_EQ(made.base_color.width, 4u);
  ASSERT_EQ(made.base_color.height, 2u);
  const int roughness[] = {255, 205, 105, 55};  // quarters of the way between the centres of both texels
  for (size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(made.base_color.rgba[4 * i + 3], 30 * i);
    EXPECT_NEAR(made.metallic_roughness.rgba[4 * i + 1], roughness[i % 4], 1);
  }
}

GltfBuilder glossy_triangle(const Json& glossy, const Json& more = Json::object()) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  gltf.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
  gltf.json["materials"] = {more};
  gltf.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = glossy;
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

/// Texture 0: a leaf's colour, half of it hole; texture 1: a mirror's.
void add_textures(GltfBuilder& gltf) {
  Bytes leaf, mirror;
  for (size_t i = 0; i < 64; ++i) {
    leaf.insert(leaf.end(), {40, 160, 60, static_cast<uint8_t>(i % 8 < 4 ? 255 : 0)});
    mirror.insert(mirror.end(), {static_cast<uint8_t>(i < 32 ? 0 : 255), 0, 0, 128});
  }
  for (const Bytes& pixels : {leaf, mirror}) {
    const Bytes png = encoded("png", 8, 8, 4, pixels).bytes;
    const int image = gltf.append("images", {{"bufferView", gltf.add_view(png)}, {"mimeType", "image/png"}});
    gltf.append("textures", {{"source", image}});
  }
}

BakeSettings raw_textures() {
  BakeSettings out;
  out.images.textures = TextureMode::raw;
  return out;
}

/// A texel of a texture's first level, as stored.
glm::ivec4 texel_of(const pack::Contents& pack, uint32_t texture, size_t number) {
  const pack::Image& image = pack.images.at(pack.textures.at(texture).image);
  glm::ivec4 out;
  for (int c = 0; c < 4; ++c) {
    out[c] = std::to_integer<int>(pack.image_data.at(image.first_byte + 4 * number + static_cast<size_t>(c)));
  }
  return out;
}

TEST(SpecularGlossiness, WithoutTheTextureThatItNamesIsRefused) {
  EXPECT_NE(error_of(glossy_triangle({{"diffuseTexture", {{"index", 0}}}}).save("bad"))
                .find("material 0, extensions, KHR_materials_pbrSpecularGlossiness, diffuseTexture, index: points past "
                      "the end, there are 0 (0)"),
            std::string::npos);
}

TEST(SpecularGlossiness, FactorsAloneBecomeFactors) {
  const Json gold = {
      {"diffuseFactor", {0, 0, 0, 0.5}}, {"specularFactor", {1.0, 0.766, 0.336}}, {"glossinessFactor", 0.9}};
  Warnings warnings;
  const Material material = glossy_triangle(gold).import(&warnings).materials.at(0);
  EXPECT_LT(glm::length(material.base_color_factor - glm::vec4(1, 0.766f, 0.336f, 0.5f)), 1e-3f);
  EXPECT_NEAR(material.metallic_factor, 1, 1e-3);
  EXPECT_NEAR(material.roughness_factor, 0.1, 1e-6);
  EXPECT_EQ(material.base_color.texture, no_index);
  EXPECT_TRUE(warnings.lines().empty());
}

TEST(SpecularGlossiness, OfNoMetalKeepsItsDiffuseTexture) {
  GltfBuilder gltf = glossy_triangle({{"diffuseTexture", {{"index", 0}}},
                                      {"diffuseFactor", {1, 0.5, 1, 1}},
                                      {"specularFactor", {0.04, 0.04, 0.04}},
                                      {"glossinessFactor", 0.25}},
                                     {{"alphaMode", "MASK"}});
  add_textures(gltf);
  const pack::Contents pack = gltf.bake(raw_textures());
  const pack::Material& material = pack.materials.at(0);
  EXPECT_LT(glm::length(material.base_color_factor - glm::vec4(1, 0.5f, 1, 1)), 1e-5f);
  EXPECT_EQ(material.metallic_factor, 0);
  EXPECT_EQ(material.roughness_factor, 0.75f);
  EXPECT_EQ(material.metallic_roughness_texture, pack::none);
  EXPECT_EQ(texel_of(pack, material.base_color_texture, 0), glm::ivec4(40, 160, 60, 255));
  EXPECT_EQ(texel_of(pack, material.base_color_texture, 4).a, 0);
  EXPECT_EQ(pack.images.size(), 1u);
}

TEST(SpecularGlossiness, CutsWhereItsDiffuseTextureHasHoles) {  // with the extension's white mirror
  GltfBuilder gltf = glossy_triangle({{"diffuseTexture", {{"index", 0}}}, {"glossinessFactor", 0.1}},
                                     {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}});
  add_textures(gltf);
  const pack::Contents pack = gltf.bake(raw_textures());
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(material.alpha_mode, pack::AlphaMode::mask);
  EXPECT_EQ(material.alpha_cutoff, 0.25f);
  EXPECT_EQ(texel_of(pack, material.base_color_texture, 3), glm::ivec4(255));
  EXPECT_EQ(texel_of(pack, material.base_color_texture, 4).a, 0);
  EXPECT_EQ(texel_of(pack, material.metallic_roughness_texture, 3), glm::ivec4(255, 230, 255, 255));
}

TEST(SpecularGlossiness, OfTwoTexturesIsMadeOfBoth) {
  const Json both = {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 1}}}};
  GltfBuilder gltf = glossy_triangle(both, {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 1}}}}});
  add_textures(gltf);
  gltf.json["materials"].push_back(gltf.json["materials"][0]);  // shares all that is made
  gltf.json["meshes"][0]["primitives"].push_back(gltf.json["meshes"][0]["primitives"][0]);
  gltf.json["meshes"][0]["primitives"][1]["material"] = 1;
  Warnings warnings;
  Scene scene = gltf.import(&warnings);
  EXPECT_TRUE(warnings.lines().empty());
  const pack::Contents pack = bake_scene(std::move(scene), raw_textures());
  EXPECT_EQ(pack.images.size(), 2u);
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(material.base_color_factor, glm::vec4(1));
  EXPECT_EQ(material.metallic_factor, 1);
  const uint32_t base = material.base_color_texture, rough = material.metallic_roughness_texture;
  EXPECT_NEAR(texel_of(pack, base, 0).g, 163, 1);  // no mirror: 0.04 of the light is the diffuse colour's as well
  EXPECT_EQ(texel_of(pack, rough, 0).b, 0);
  EXPECT_EQ(texel_of(pack, rough, 0).g, 127);
  EXPECT_GT(texel_of(pack, rough, 63).b, 250);
  EXPECT_GT(texel_of(pack, base, 63).r, 250);
  EXPECT_LT(texel_of(pack, base, 63).g, 5);
}

TEST(SpecularGlossiness, WhoseMirrorIsLeftOutIsNoMirror) {
  GltfBuilder gltf = glossy_triangle(
      {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 1}, {"texCoord", 2}}}});
  add_textures(gltf);
  Warnings warnings;
  const Scene scene = gltf.import(&warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("specularGlossinessTexture: asks for a texture coordinate set above"),
            std::string::npos);
  const Material& material = scene.materials.at(0);
  EXPECT_EQ(material.metallic_factor, 0);
  EXPECT_EQ(material.roughness_factor, 1);
  EXPECT_EQ(scene.textures.at(material.base_color.texture).image, 0u);  // the diffuse image as it is
  EXPECT_EQ(material.metallic_roughness.texture, no_index);
}

/// A material of a diffuse image `long_side` wide and one high, and a mirror's image that stands on end.
GltfBuilder crossed_images(int long_side) {
  GltfBuilder gltf =
      glossy_triangle({{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 1}}}});
  const Bytes pixels(static_cast<size_t>(3 * long_side), 200);
  for (const EncodedImage& image : {encoded("png", long_side, 1, 3, pixels), encoded("png", 1, long_side, 3, pixels)}) {
    const int number = gltf.append("images", {{"bufferView", gltf.add_view(image.bytes)}, {"mimeType", "image/png"}});
    gltf.append("textures", {{"source", number}});
  }
  return gltf;
}

TEST(SpecularGlossiness, OfCrossedImagesTakesNoMoreMemoryThanIsCounted) {
  const Scene scene = crossed_images(1024).import();
  const uint32_t image = scene.textures.at(scene.materials.at(0).base_color.texture).image;
  EXPECT_EQ(claimed_texels(scene, image), 2u * 1024 + 2u * 1024 * 1024);
  EXPECT_EQ(decode_image(scene, image).color.rgba.size(), size_t{4} * 1024 * 1024);
  const std::string error = error_of(crossed_images(16384).save("crossed"));  // two images of a gigabyte
  EXPECT_NE(
      error.find("image 0: its shape differs too much from that of its specularGlossinessTexture to make one image of "
                 "both (16384x1 and 1x16384)"),
      std::string::npos)
      << error;
}

TEST(SpecularGlossiness, DecidesWithItsConvertedTexelsWhatIsGlass) {
  GltfBuilder gltf =
      glossy_triangle({{"specularGlossinessTexture", {{"index", 1}}}, {"specularFactor", {0.04, 0.04, 0.04}}});
  add_textures(gltf);
  gltf.json["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  EXPECT_TRUE(bake_scene(gltf.import(), raw_textures()).materials.at(0).shadowless);  // no metal anywhere
  const Json metal = {{"diffuseTexture", {{"index", 0}}}};                            // a white mirror all over
  gltf.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = metal;
  EXPECT_FALSE(bake_scene(gltf.import(), raw_textures()).materials.at(0).shadowless);
}

TEST(SpecularGlossiness, OfTexturesThatAreMappedDifferentlyLosesItsMetalWithALine) {
  GltfBuilder gltf = glossy_triangle(
      {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 1}, {"texCoord", 1}}}});
  add_textures(gltf);
  Warnings warnings;
  Scene scene = gltf.import(&warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("material 0, KHR_materials_pbrSpecularGlossiness: its two textures are mapped"),
            std::string::npos);
  const pack::Contents pack = bake_scene(std::move(scene), raw_textures());
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(material.metallic_factor, 0);
  EXPECT_EQ(material.uv1_mask, 2u);
  EXPECT_EQ(texel_of(pack, material.base_color_texture, 0), glm::ivec4(40, 160, 60, 255));
  EXPECT_EQ(texel_of(pack, material.metallic_roughness_texture, 0).g, 127);
}

}  // namespace
}  // namespace chandelier::baker::test
