// SPDX-License-Identifier: Apache-2.0
// Contents that break a rule: opening names the field. pack_every_rule_test.py does the same for each field of the
// schema; here is every kind of rule with its exact words, and the rules between fields.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>

#include "pack_breach.h"

namespace chandelier::pack::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

/// Makes the second image a texel of half floats.
void set_halves(Contents& c, const std::array<uint16_t, 4>& halves) {
  c.images[1].format = ImageFormat::rgba16_sfloat;
  c.images[1].size_bytes = c.images[1].stored_bytes = sizeof(halves);
  std::memcpy(&c.image_data[c.images[1].first_byte], halves.data(), sizeof(halves));
}

const Breach breaches[] = {
    // Every kind of rule
    {"NotANumber", [](Contents& c) { c.positions[3].position_ls.y = nan; },
     "positions[3].position_ls.y: nan is not finite"},
    {"Infinite", [](Contents& c) { c.lights[0].color.z = inf; }, "lights[0].color.z: inf is not finite"},
    {"MinusInfinite", [](Contents& c) { c.cameras[0].znear_m = -inf; }, "cameras[0].znear_m: -inf is not finite"},
    {"ArrayElement", [](Contents& c) { c.instances[1].world_from_local[2].w = nan; },
     "instances[1].world_from_local[2].w: nan is not finite"},
    {"BelowMinimum", [](Contents& c) { c.lights[1].intensity = -0.5f; }, "lights[1].intensity: -0.5 is below 0"},
    {"AboveMaximum", [](Contents& c) { c.materials[1].roughness_factor = 1.5f; },
     "materials[1].roughness_factor: 1.5 is above 1"},
    {"IntegerBelowMinimum", [](Contents& c) { c.bake_info.batch_triangles = 0; },
     "bake_info.batch_triangles: 0 is below 1"},
    {"IntegerAboveMaximum", [](Contents& c) { c.materials[0].uv1_mask = 32; }, "materials[0].uv1_mask: 32 is above 31"},
    {"Enum", [](Contents& c) { c.lights[2].type = LightType{3}; }, "lights[2].type: 3 is no LightType"},
    {"Index", [](Contents& c) { c.batches[1].material = 9; }, "batches[1].material: 9 is not below the 2 materials"},
    {"IndexIsNone", [](Contents& c) { c.batches[1].material = none; },
     "batches[1].material: 4294967295 is not below the 2 materials"},
    {"OptionalIndex", [](Contents& c) { c.materials[0].emissive_texture = 2; },
     "materials[0].emissive_texture: 2 is not below the 2 textures"},
    {"LastIndex", [](Contents& c) { c.indices[8].vertex = 7; }, "indices[8].vertex: 7 is not below the 7 positions"},
    {"Run", [](Contents& c) { c.batches[0].first_index = 9; },
     "batches[0].first_index: 9 plus index_count 3 is past the 9 indices"},
    {"RunWraps", [](Contents& c) { c.batches[0].first_index = 0xFFFFFFFFu; },
     "batches[0].first_index: 4294967295 plus index_count 3 is past the 9 indices"},
    {"LongRunWraps", [](Contents& c) { c.images[0].first_byte = ~uint64_t{15}; },
     "images[0].first_byte: 18446744073709551600 plus stored_bytes 44 is past the 576 image_data"},
    {"String", [](Contents& c) { c.materials[1].name.size_bytes = 1000; },
     "materials[1].name.offset_bytes: 33 plus size_bytes 1000 is past the 96 strings"},
    {"StringWraps",
     [](Contents& c) {
       c.bake_info.source = {2, 0xFFFFFFFEu};
     },
     "bake_info.source.offset_bytes: 2 plus size_bytes 4294967294 is past the 96 strings"},
    {"LargeBatch",
     [](Contents& c) {
       c.indices.resize(1539);
       c.batches[1] = c.batches[0];
       c.batches[0].index_count = 1539;
     },
     "batches[0].index_count: 1539 is above 1536"},
    {"SameCount", [](Contents& c) { c.vertex_attributes.pop_back(); }, "vertex_attributes: 6 records for 7 positions"},
    // Rules between fields
    {"IndicesOfNoTriangle", [](Contents& c) { c.indices.push_back({0}); },
     "indices: 10 records are not a multiple of 3"},
    {"FirstIndexInATriangle", [](Contents& c) { c.batches[0].first_index = 2; },
     "batches[0].first_index: 2 is not a multiple of 3"},
    {"IndexCountOfNoTriangle", [](Contents& c) { c.batches[0].index_count = 4; },
     "batches[0].index_count: 4 is not a multiple of 3"},
    {"SceneBounds", [](Contents& c) { c.bake_info.bounds_min_ws.y = 2; },
     "bake_info.bounds_min_ws.y: 2 is above the maximum 1"},
    {"BatchBounds", [](Contents& c) { c.batches[1].bounds_min_ls.z = 0.5f; },
     "batches[1].bounds_min_ls.z: 0.5 is above the maximum 0"},
    {"MaskedBeforeOpaque", [](Contents& c) { std::swap(c.batch_instances[0], c.batch_instances[2]); },
     "batch_instances[1]: not sorted by material, opaque ones first"},
    {"MaterialsInterleaved", [](Contents& c) { c.batch_instances.push_back(c.batch_instances[0]); },
     "batch_instances[5]: not sorted by material, opaque ones first"},
    {"DrawBounds", [](Contents& c) { c.batch_instances[3].bounds_min_ws.x = 4; },
     "batch_instances[3].bounds_min_ws.x: 4 is above the maximum 3"},
    {"ImageNotAligned", [](Contents& c) { c.images[1].first_byte = 44; },
     "images[1].first_byte: 44 is not a multiple of 16"},
    {"ImageSize", [](Contents& c) { c.images[0].size_bytes = 40; },
     "images[0].size_bytes: 40 where its levels have 44"},
    {"ImageLevels", [](Contents& c) { c.images[0].level_count = 4; },
     "images[0].level_count: 4 is above the 3 levels of its size"},
    {"ImageFormat", [](Contents& c) { c.images[1].format = ImageFormat{7}; }, "images[1].format: 7 is no ImageFormat"},
    {"HalfFloatSize", [](Contents& c) { c.images[1].format = ImageFormat::rgba16_sfloat; },
     "images[1].size_bytes: 4 where its levels have 8"},
    {"HalfFloatInfinite",
     [](Contents& c) {
       set_halves(c, {0, 0x7BFF, 0x7C00, 0});
     },
     "images[1]: half float 2 is negative or not finite (31744)"},
    {"HalfFloatNotANumber",
     [](Contents& c) {
       set_halves(c, {0x7E00, 0, 0, 0});
     },
     "images[1]: half float 0 is negative or not finite (32256)"},
    {"HalfFloatNegative",
     [](Contents& c) {
       set_halves(c, {0, 0, 0, 0xBC00});
     },
     "images[1]: half float 3 is negative or not finite (48128)"},
    {"ImageCodec", [](Contents& c) { c.images[1].codec = ImageCodec{2}; }, "images[1].codec: 2 is no ImageCodec"},
    {"RawImageOfAnotherSize", [](Contents& c) { c.images[1].stored_bytes = 3; },
     "images[1].stored_bytes: 3 of a raw image of 4 bytes"},
    {"CodedImageOfNoBytes",
     [](Contents& c) {
       c.images[1].codec = ImageCodec::zstd;
       c.images[1].stored_bytes = 0;
     },
     "images[1].size_bytes: 4 are too many for the stored 0"},
    {"CodedImageTooLarge",
     [](Contents& c) {
       c.images[1].codec = ImageCodec::zstd;
       c.images[1].width = c.images[1].height = 256;
       c.images[1].size_bytes = 262144;
     },
     "images[1].size_bytes: 262144 are too many for the stored 4"},
    {"ImagesOverlap", [](Contents& c) { c.images[1].first_byte = 32; },
     "images[1].first_byte: 32 is before the end of the image before, 44"},
    {"LargestImage",
     [](Contents& c) {
       c.images[0].width = c.images[0].height = 16384;
       c.images[0].level_count = 15;
     },
     "images[0].size_bytes: 44 where its levels have 1431655764"},
    {"Cones", [](Contents& c) { c.lights[1].inner_cone_cos = 0.25f; },
     "lights[1].inner_cone_cos: 0.25 is below outer_cone_cos 0.5"},
    {"LightDirection",
     [](Contents& c) {
       c.lights[1].direction_ws = {0, -2, 0};
     },
     "lights[1].direction_ws: length 2 is not 1"},
    {"NoLightDirection",
     [](Contents& c) {
       c.lights[0].direction_ws = {0, 0, 0};
     },
     "lights[0].direction_ws: length 0 is not 1"},
    {"HugeLightDirection",
     [](Contents& c) {
       c.lights[0].direction_ws = {3e38f, 0, 0};
     },
     "lights[0].direction_ws: length inf is not 1"},
    {"CameraForward", [](Contents& c) { c.cameras[0].forward_ws.z = -0.5f; },
     "cameras[0].forward_ws: length 0.5 is not 1"},
    {"CameraUp", [](Contents& c) { c.cameras[0].up_ws.y = 3; }, "cameras[0].up_ws: length 3 is not 1"},
    {"CameraUpIsForward",
     [](Contents& c) {
       c.cameras[0].up_ws = {0, 0, -1};
     },
     "cameras[0].up_ws: not perpendicular to forward_ws, their dot product is 1"},
};

class PackRules : public testing::TestWithParam<Breach> {};

TEST_P(PackRules, BreachIsNamed) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Each, PackRules, testing::ValuesIn(breaches), name_of_breach);

TEST(PackRulesLimits, AreAllowed) {
  const Folder folder;
  Contents contents = sample();
  contents.lights[0].inner_cone_cos = contents.lights[0].outer_cone_cos = -1;
  contents.lights[0].direction_ws = {0, 1.0009f, 0};
  contents.positions[0].position_ls.x = std::numeric_limits<float>::max();
  contents.positions[1].position_ls.x = std::numeric_limits<float>::denorm_min();
  contents.materials[0].uv1_mask = 31;
  contents.bake_info.batch_triangles = 512;
  contents.bake_info.source = {89, 0};
  write(folder / "a.pack", contents);
  EXPECT_EQ(open_error(folder / "a.pack"), "");
}

// Every section alone can be large; the fault is found wherever it lies, also past the part that vector code handles.
TEST(PackRulesLimits, AFaultIsFoundAnywhereInALongSection) {
  Contents contents = sample();
  contents.positions.resize(1003);
  contents.vertex_attributes.resize(1003);
  for (const size_t at : {size_t{4}, size_t{500}, size_t{1001}, size_t{1002}}) {
    Contents broken = contents;
    broken.vertex_attributes[at].uv1.y = nan;
    EXPECT_EQ(check(view_of(broken)), "vertex_attributes[" + std::to_string(at) + "].uv1.y: nan is not finite");
  }
  EXPECT_EQ(check(view_of(contents)), "");
}

TEST(PackRules, HalfFloatsUpToTheLargestAreFine) {
  const Folder folder;
  Contents contents = sample();
  set_halves(contents, {0, 0x7BFF, 1, 0x3C00});
  write(folder / "a.pack", contents);
  EXPECT_EQ(open_error(folder / "a.pack"), "");
}

}  // namespace
}  // namespace chandelier::pack::test
