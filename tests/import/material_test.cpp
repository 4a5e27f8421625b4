// SPDX-License-Identifier: Apache-2.0
// Materials, textures and how images are found.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

/// A 1x1 PNG, red with alpha 128.
const std::vector<uint8_t> png = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00,
                                  0x00, 0x1F, 0x15, 0xC4, 0x89, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78,
                                  0x9C, 0x63, 0xF8, 0xCF, 0xC0, 0xD0, 0x00, 0x00, 0x04, 0x81, 0x01, 0x80, 0x2C, 0x55,
                                  0xCE, 0xB0, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

GltfBuilder with_material(const Json& material) {
  GltfBuilder gltf = one_triangle();
  gltf.json["materials"] = {material};
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

GltfBuilder with_texture(const Json& material) {
  GltfBuilder gltf = with_material(material);
  gltf.json["images"] = {{{"uri", "data:image/png;base64," + base64(png)}, {"name", "red"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  return gltf;
}

TEST(Material, IsGltfsDefaultWhereThePrimitiveNamesNone) {
  const pack::Contents pack = one_triangle().bake();
  ASSERT_EQ(pack.materials.size(), 1u);
  const pack::Material& material = pack.materials[0];
  EXPECT_EQ(material.base_color_factor, glm::vec4(1));
  EXPECT_EQ(material.metallic_factor, 1);
  EXPECT_EQ(material.roughness_factor, 1);
  EXPECT_EQ(material.emissive, glm::vec3(0));
  EXPECT_EQ(material.alpha_mode, pack::AlphaMode::opaque);
  EXPECT_EQ(material.double_sided, 0u);
  EXPECT_EQ(material.base_color_texture, pack::none);
}

TEST(Material, KeepsItsFactors) {
  const pack::Contents pack =
      with_material({{"name", "brass"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                     {"emissiveFactor", {1, 0.5, 0}},
                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}},
                     {"doubleSided", true}})
          .bake();
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(text_of(pack, material.name), "brass");
  EXPECT_EQ(material.base_color_factor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(material.metallic_factor, 0.5f);
  EXPECT_EQ(material.roughness_factor, 0.25f);
  EXPECT_EQ(material.emissive, glm::vec3(8, 4, 0));
  EXPECT_EQ(material.double_sided, 1u);
}

TEST(Material, KeepsAnEmissiveStrengthBeyond32Bits) {
  const Json strength = {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4294967295u}}}};
  const Scene scene = with_material({{"emissiveFactor", {0.5, 0, 0}}, {"extensions", strength}}).import();
  EXPECT_EQ(scene.materials.at(0).emissive.r, 2147483648.0f);
}

TEST(Material, MasksAndTurnsBlendingIntoMasking) {
  const pack::Contents mask = with_material({{"alphaMode", "MASK"}, {"alphaCutoff", 0.3}}).bake();
  EXPECT_EQ(mask.materials.at(0).alpha_mode, pack::AlphaMode::mask);
  EXPECT_EQ(mask.materials.at(0).alpha_cutoff, 0.3f);
  Warnings warnings;
  const Scene blend = with_material({{"alphaMode", "BLEND"}, {"alphaCutoff", 0.3}}).import(&warnings);
  EXPECT_TRUE(blend.materials.at(0).masked);
  EXPECT_EQ(blend.materials.at(0).alpha_cutoff, 0.5f);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("1 material with alphaMode BLEND baked as MASK"), std::string::npos);
}

TEST(Texture, KeepsItsSampler) {
  GltfBuilder gltf = with_texture({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}}};
  gltf.json["textures"][0]["sampler"] = 0;
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.textures.size(), 1u);
  EXPECT_EQ(pack.textures[0].wrap_u, pack::Wrap::clamp_to_edge);
  EXPECT_EQ(pack.textures[0].wrap_v, pack::Wrap::mirrored_repeat);
  EXPECT_EQ(pack.textures[0].mag_filter, pack::Filter::nearest);
  EXPECT_EQ(pack.textures[0].min_filter, pack::Filter::linear);
}

TEST(Texture, RepeatsAndIsLinearWithoutASampler) {
  const pack::Contents pack = with_texture({{"emissiveTexture", {{"index", 0}}}}).bake();
  EXPECT_EQ(pack.textures.at(0).wrap_u, pack::Wrap::repeat);
  EXPECT_EQ(pack.textures.at(0).wrap_v, pack::Wrap::repeat);
  EXPECT_EQ(pack.textures.at(0).mag_filter, pack::Filter::linear);
  EXPECT_EQ(pack.textures.at(0).min_filter, pack::Filter::linear);
}

TEST(Texture, SaysWhichOnesReadTheSecondCoordinates) {
  const Json uv1 = {{"index", 0}, {"texCoord", 1}};
  const pack::Contents pack = with_texture({{"pbrMetallicRoughness", {{"metallicRoughnessTexture", uv1}}},
                                            {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                                            {"occlusionTexture", {{"index", 0}, {"texCoord", 1}, {"strength", 0.25}}}})
                                  .bake();
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(material.uv1_mask, 2u | 8u);  // metallic-roughness is bit 1, occlusion bit 3
  EXPECT_EQ(material.normal_scale, 0.5f);
  EXPECT_EQ(material.occlusion_strength, 0.25f);
}

TEST(Texture, StoresAnImageOncePerUse) {
  const pack::Contents pack =
      with_texture({{"pbrMetallicRoughness",
                     {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
                    {"occlusionTexture", {{"index", 0}}},
                    {"emissiveTexture", {{"index", 0}}}})
          .bake();
  ASSERT_EQ(pack.images.size(), 2u);  // as colour for two, as data for two
  EXPECT_EQ(pack.images[0].format, pack::ImageFormat::rgba8_srgb);
  EXPECT_EQ(pack.images[1].format, pack::ImageFormat::rgba8_unorm);
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(material.base_color_texture, material.emissive_texture);
  EXPECT_EQ(material.metallic_roughness_texture, material.occlusion_texture);
  EXPECT_NE(material.base_color_texture, material.occlusion_texture);
}

TEST(Texture, StoresIdenticalFilesOnceAndDecodesThemOnce) {
  GltfBuilder gltf = with_texture({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                   {"emissiveTexture", {{"index", 1}}},
                                   {"occlusionTexture", {{"index", 1}}}});
  gltf.json["images"].push_back({{"uri", "data:image/png;base64," + base64(png)}, {"name", "red again"}});
  gltf.json["textures"].push_back({{"source", 1}});
  Report report;
  Warnings warnings;
  const pack::Contents pack = baker::bake(gltf.import(), {}, Progress(false), report, warnings);
  ASSERT_EQ(pack.images.size(), 2u);  // as colour and as data
  const pack::Material& material = pack.materials.at(0);
  EXPECT_EQ(pack.textures.at(material.base_color_texture).image, pack.textures.at(material.emissive_texture).image);
  EXPECT_NE(pack.textures.at(material.occlusion_texture).image, pack.textures.at(material.emissive_texture).image);
  const auto images = std::find_if(report.passes.begin(), report.passes.end(),
                                   [](const PassReport& pass) { return pass.name == "images"; });
  ASSERT_NE(images, report.passes.end());
  const std::map<std::string, double> counts(images->counts.begin(), images->counts.end());
  EXPECT_EQ(counts.at("images"), 2);
  EXPECT_EQ(counts.at("decoded"), 1);
  EXPECT_EQ(counts.at("shared"), 2);
}

/// A scene without a file: one material whose base colour is image 0.
Scene scene_with_image(const std::vector<uint8_t>& bytes) {
  Scene scene;
  scene.images = {{"image", "test: image", {}}};
  scene.images[0].bytes = bytes;
  scene.textures = {{}};
  scene.materials = {{}};
  scene.materials[0].base_color.texture = 0;
  return scene;
}

TEST(Texture, KeepsAlphaApartWhereOnlyOneMaterialTestsIt) {
  Scene scene = scene_with_image(png);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].masked = true;
  const pack::Contents pack = bake_scene(std::move(scene), {});
  EXPECT_EQ(pack.images.size(), 2u);
}

TEST(Texture, TransformsAreKeptAndTellTexturesApart) {
  Scene scene = scene_with_image(png);
  Material& material = scene.materials[0];
  material.base_color.uv_transform = {glm::vec3(0, 2, 0.5f), glm::vec3(-1, 0, 0.25f)};
  material.emissive_map.texture = 0;
  const pack::Contents pack = bake_scene(std::move(scene), {});
  ASSERT_EQ(pack.textures.size(), 2u);
  ASSERT_EQ(pack.images.size(), 1u);
  const pack::Texture& turned = pack.textures.at(pack.materials.at(0).base_color_texture);
  EXPECT_EQ(turned.uv_transform[0], glm::vec3(0, 2, 0.5f));
  EXPECT_EQ(turned.uv_transform[1], glm::vec3(-1, 0, 0.25f));
  EXPECT_EQ(pack.textures.at(pack.materials.at(0).emissive_texture).uv_transform[0], glm::vec3(1, 0, 0));
}

TEST(Texture, CanBeLeftOut) {
  Scene scene = scene_with_image({1, 2, 3});  // not even looked at
  scene.materials[0].emissive = glm::vec3(5);
  scene.materials[0].emissive_map.texture = 0;
  BakeSettings settings;
  settings.images.textures = TextureMode::none;
  const pack::Contents pack = bake_scene(std::move(scene), settings);
  EXPECT_TRUE(pack.images.empty());
  EXPECT_TRUE(pack.textures.empty());
  EXPECT_EQ(pack.materials.at(0).base_color_texture, pack::none);
  EXPECT_EQ(pack.materials.at(0).emissive, glm::vec3(0));  // it glowed in places, not all over
}

TEST(Material, KeepsThatItIsUnlit) {
  Scene scene = scene_with_image(png);
  scene.materials[0].unlit = true;
  EXPECT_EQ(bake_scene(std::move(scene), {}).materials.at(0).unlit, 1u);
}

void expect_red(const GltfBuilder& gltf) {
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.images.size(), 1u);
  ASSERT_GE(pack.image_data.size(), 4u);
  EXPECT_EQ(pack.image_data[0], std::byte{255});
  EXPECT_EQ(pack.image_data[1], std::byte{0});
  EXPECT_EQ(pack.image_data[3], std::byte{128});  // and red is not multiplied by it
}

TEST(Image, IsReadFromADataUriABufferViewOrAFile) {
  const Json material = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  expect_red(with_texture(material));

  GltfBuilder view = with_texture(material);
  view.json["images"][0] = {{"bufferView", view.add_view(png)}, {"mimeType", "image/png"}};
  expect_red(view);

  std::filesystem::create_directories(scratch_folder() / "a b");
  write_bytes(scratch_folder() / "a b" / "rot ❤.png", {png.begin(), png.end()});
  write_bytes(scratch_folder() / "50%25.png", {png.begin(), png.end()});
  GltfBuilder file = with_texture(material);
  for (const char* uri : {"a%20b/rot%20%E2%9D%A4.png", "a b/rot ❤.png", "50%25.png"}) {
    file.json["images"][0] = {{"uri", uri}};
    expect_red(file);
  }
}

TEST(Image, IsNotReadWhereNothingUsesIt) {
  GltfBuilder gltf = with_texture({{"name", "plain"}});
  gltf.json["images"][0] = {{"uri", "nowhere.png"}};
  EXPECT_TRUE(gltf.bake().images.empty());
}

}  // namespace
}  // namespace chandelier::baker::test
