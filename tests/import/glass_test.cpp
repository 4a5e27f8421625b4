// SPDX-License-Identifier: Apache-2.0
// KHR_materials_transmission: what lets light through casts no shadow, and what else does.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

/// A PNG of 2 by 1 texels: red, which lets light through and is no metal, and blue, which does not and is.
const std::vector<uint8_t> png = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
                                  0x00, 0x7B, 0x40, 0xE8, 0xDD, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78,
                                  0xDA, 0x63, 0xF8, 0xCF, 0x00, 0x04, 0xFF, 0x01, 0x07, 0x00, 0x01, 0xFF, 0x3D, 0x7D,
                                  0x8C, 0x49, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

/// The triangle, of a material that lets `factor` of the light through and is no metal.
GltfBuilder pane(double factor) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_materials_transmission"};
  gltf.json["materials"] = {{{"name", "glass"},
                             {"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                             {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", factor}}}}}}};
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

Json& material(GltfBuilder& gltf) {
  return gltf.json["materials"][0];
}

struct Baked {
  pack::Contents pack;
  std::vector<std::string> warnings;
};

Baked bake_with(const GltfBuilder& gltf, bool glass_shadows = false) {
  Warnings warnings;
  Report report;
  BakeSettings settings;
  settings.glass_shadows = glass_shadows;
  Scene scene = gltf.import(&warnings);
  Baked out{bake(std::move(scene), settings, Progress(false), report, warnings), {}};
  check(out.pack, report);
  out.warnings = warnings.lines();
  return out;
}

/// How many of the drawn triangles cast a shadow, and how many do not.
std::pair<uint32_t, uint32_t> casting(const pack::Contents& pack) {
  std::pair<uint32_t, uint32_t> out;
  for (const pack::Batch& batch : pack.batches) {
    (pack.materials[batch.material].shadowless ? out.second : out.first) += batch.index_count / 3;
  }
  return out;
}

TEST(Glass, ThrowsNoShadowFromHalfTheLightOn) {
  for (const double factor : {0.0, 0.25, 0.5, 1.0}) {
    const Baked baked = bake_with(pane(factor));
    const pack::Material& record = baked.pack.materials.at(0);
    EXPECT_EQ(record.shadowless, factor >= 0.5 ? 1u : 0u) << factor;
    EXPECT_EQ(record.transmission_factor, static_cast<float>(factor));
    ASSERT_EQ(baked.warnings.size(), factor >= 0.5 ? 1u : 0u) << factor;
    if (factor < 0.5) continue;
    EXPECT_EQ(baked.warnings[0],
              "scene: materials: light passes through them, so they cast no shadow (--glass-shadows gives them one) "
              "(glass)");
  }
}

TEST(Glass, ThrowsOneOnRequest) {
  const Baked baked = bake_with(pane(1), true);
  EXPECT_EQ(baked.pack.materials.at(0).shadowless, 0u);
  EXPECT_EQ(baked.pack.materials.at(0).transmission_factor, 1);
  EXPECT_TRUE(baked.warnings.empty());
}

TEST(Glass, IsNoMetal) {
  GltfBuilder gltf = pane(1);
  material(gltf)["pbrMetallicRoughness"].erase("metallicFactor");  // 1 unless the file says so
  EXPECT_EQ(casting(bake_with(gltf).pack), std::pair(1u, 0u));
  material(gltf)["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  EXPECT_EQ(casting(bake_with(gltf).pack), std::pair(0u, 1u));
}

TEST(Glass, DoesWhatItsAuthorSays) {
  GltfBuilder gltf = pane(1);
  material(gltf)["extras"]["chandelier"]["shadow"] = true;
  EXPECT_EQ(casting(bake_with(gltf).pack), std::pair(1u, 0u));
  material(gltf)["extras"]["chandelier"]["shadow"] = false;
  const Baked said = bake_with(gltf, true);
  EXPECT_EQ(casting(said.pack), std::pair(0u, 1u));
  EXPECT_TRUE(said.warnings.empty());
}

/// Two squares side by side, the left one under the red texel.
GltfBuilder pane_with_frame() {
  GltfBuilder gltf = pane(1);
  std::vector<float> positions, uvs;
  std::vector<uint16_t> indices;
  for (uint16_t i = 0; i < 2; ++i) {
    for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
      positions.insert(positions.end(), {static_cast<float>(x + i), static_cast<float>(y), 0});
      uvs.insert(uvs.end(), {0.5f * static_cast<float>(x + i), static_cast<float>(y)});
    }
    for (const int corner : {0, 1, 2, 0, 2, 3}) indices.push_back(static_cast<uint16_t>(4 * i + corner));
  }
  gltf.json["meshes"][0]["primitives"][0] = {
      {"attributes", {{"POSITION", gltf.add_positions(positions)}, {"TEXCOORD_0", gltf.add_floats(uvs, "VEC2", 2)}}},
      {"indices", gltf.add_indices(indices)},
      {"material", 0}};
  gltf.json["images"] = {{{"uri", "data:image/png;base64," + base64(png)}}};
  gltf.json["textures"] = {{{"source", 0}}};
  return gltf;
}

Json& transmission(GltfBuilder& gltf) {
  return material(gltf)["extensions"]["KHR_materials_transmission"];
}

/// Whether each caster lies on this side of x = 1.
void expect_casters(const pack::Contents& pack, bool right) {
  for (const pack::BatchInstance& placed : pack.batch_instances) {
    if (pack.materials[pack.batches[placed.batch].material].shadowless) continue;
    EXPECT_EQ(placed.bounds_min_ws.x, right ? 1 : 0);
    EXPECT_EQ(placed.bounds_max_ws.x, right ? 2 : 1);
  }
}

TEST(Glass, IsWhereItsTextureHasIt) {
  GltfBuilder gltf = pane_with_frame();
  transmission(gltf)["transmissionTexture"] = {{"index", 0}};
  const Baked baked = bake_with(gltf);
  EXPECT_EQ(casting(baked.pack), std::pair(2u, 2u));
  expect_casters(baked.pack, true);
  EXPECT_EQ(baked.pack.materials.size(), 2u);
  EXPECT_EQ(baked.warnings.size(), 1u);
  EXPECT_EQ(text_of(baked.pack, baked.pack.materials[1].name), "glass");
  EXPECT_TRUE(baked.pack.images.empty());  // nothing that is drawn reads it
  EXPECT_EQ(casting(bake_with(gltf, true).pack), std::pair(4u, 0u));
}

TEST(Glass, IsWhereItsTextureHasNoMetal) {
  GltfBuilder gltf = pane_with_frame();
  material(gltf)["pbrMetallicRoughness"] = {{"metallicRoughnessTexture", {{"index", 0}}}};
  const Baked baked = bake_with(gltf);
  EXPECT_EQ(casting(baked.pack), std::pair(2u, 2u));
  expect_casters(baked.pack, true);
}

/// Half a width on, and repeated: the right one is red.
TEST(Glass, FollowsTheTexturesTransform) {
  GltfBuilder gltf = pane_with_frame();
  gltf.json["extensionsUsed"].push_back("KHR_texture_transform");
  transmission(gltf)["transmissionTexture"] = {{"index", 0},
                                               {"extensions", {{"KHR_texture_transform", {{"offset", {-7.5, 0}}}}}}};
  const Baked baked = bake_with(gltf);
  EXPECT_EQ(casting(baked.pack), std::pair(2u, 2u));
  expect_casters(baked.pack, false);
}

TEST(Glass, NeedsNoSecondMaterialWhereItsTextureIsGlassAllOver) {
  GltfBuilder gltf = pane_with_frame();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      gltf.add_floats(std::vector<float>(16, 0.25f), "VEC2", 2);
  transmission(gltf)["transmissionTexture"] = {{"index", 0}};
  const pack::Contents pack = bake_with(gltf).pack;
  EXPECT_EQ(pack.materials.size(), 1u);
  EXPECT_EQ(casting(pack), std::pair(0u, 4u));
}

TEST(Glass, WithoutItsTextureThrowsAShadow) {
  GltfBuilder gltf = pane_with_frame();
  transmission(gltf)["transmissionTexture"] = {{"index", 0}};
  gltf.json["textures"] = {Json::object()};
  const Baked baked = bake_with(gltf);
  EXPECT_EQ(casting(baked.pack), std::pair(4u, 0u));
  EXPECT_EQ(baked.pack.materials.at(0).transmission_factor, 0);
  ASSERT_EQ(baked.warnings.size(), 1u);
  EXPECT_NE(baked.warnings[0].find("transmissionTexture: texture has no image and is left out"), std::string::npos);
}

TEST(Glass, IsRefusedWhereItIsNoNumber) {
  const std::map<std::string, Json> factors = {{"is out of range (1.5)", 1.5},
                                               {"is out of range (-0.1)", -0.1},
                                               {"is not a number (\"clear\")", "clear"},
                                               {"is not a number (null)", nullptr}};
  for (const auto& [says, factor] : factors) {
    GltfBuilder gltf = pane(1);
    transmission(gltf)["transmissionFactor"] = factor;
    EXPECT_NE(error_of(gltf.save("bad"))
                  .find("material 0 'glass', extensions, KHR_materials_transmission, "
                        "transmissionFactor: " +
                        says),
              std::string::npos)
        << error_of(gltf.save("bad"));
  }
}

/// A closed box of which a side is glass: light gets in, so that no side may be left out of shadow maps for its facing.
TEST(Glass, LeavesItsShellOpen) {
  GltfBuilder gltf = pane(1);
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const int positions = gltf.add_positions(corners);
  const auto primitive = [&](const std::vector<uint16_t>& indices) {
    return Json{{"attributes", {{"POSITION", positions}}}, {"indices", gltf.add_indices(indices)}};
  };
  Json sides = primitive({0, 2, 1, 0, 1, 3, 0, 3, 2}), slope = primitive({1, 2, 3});
  gltf.json["meshes"][0]["primitives"] = {sides, slope};
  for (const pack::Batch& batch : gltf.bake().batches) EXPECT_EQ(batch.closed, 1u);
  gltf.json["meshes"][0]["primitives"][1]["material"] = 0;
  for (const pack::Batch& batch : gltf.bake().batches) EXPECT_EQ(batch.closed, 0u);
}

TEST(Glass, WithoutTexturesIsToldByFactorsAlone) {
  GltfBuilder gltf = pane(1);
  const int view = gltf.add_view(std::vector<uint8_t>{1, 2, 3, 4});  // no image, which nobody looks at
  gltf.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  material(gltf)["pbrMetallicRoughness"] = {{"metallicFactor", 0.25}, {"metallicRoughnessTexture", {{"index", 0}}}};
  BakeSettings settings;
  EXPECT_THROW(gltf.bake(settings), Error);
  settings.images.textures = TextureMode::none;
  EXPECT_EQ(casting(gltf.bake(settings)), std::pair(0u, 1u));
  material(gltf)["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = {{"index", 0}};
  EXPECT_EQ(casting(gltf.bake(settings)), std::pair(1u, 0u));  // without the map that says where
}

}  // namespace
}  // namespace chandelier::baker::test
