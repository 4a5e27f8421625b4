// SPDX-License-Identifier: Apache-2.0
// Images that are damaged, of which viewers show what is there: a warning, or with --strict an error.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstddef>

#include "bake/decode.h"
#include "encode_image.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

using Bytes = std::vector<uint8_t>;

constexpr size_t side = 64;

/// Where a chunk of a PNG begins: its length, then its type.
size_t chunk_at(const Bytes& png, const std::string& type) {
  return static_cast<size_t>(std::search(png.begin(), png.end(), type.begin(), type.end()) - png.begin()) - 4;
}

/// A chunk with `data`; its checksum is right, or off by one.
Bytes chunk(const std::string& type, const Bytes& data, bool right = true) {
  const auto u32 = [](uint32_t value) {
    return Bytes{static_cast<uint8_t>(value >> 24), static_cast<uint8_t>(value >> 16), static_cast<uint8_t>(value >> 8),
                 static_cast<uint8_t>(value)};
  };
  Bytes named(type.begin(), type.end());
  named.insert(named.end(), data.begin(), data.end());
  Bytes out = u32(static_cast<uint32_t>(data.size()));
  out.insert(out.end(), named.begin(), named.end());
  const Bytes sum = u32(static_cast<uint32_t>(crc32_z(0, named.data(), named.size())) + (right ? 0 : 1));
  out.insert(out.end(), sum.begin(), sum.end());
  return out;
}

EncodedImage with_chunk(EncodedImage png, const Bytes& added) {
  png.bytes.insert(png.bytes.begin() + static_cast<ptrdiff_t>(chunk_at(png.bytes, "IDAT")), added.begin(), added.end());
  return png;
}

EncodedImage noisy_png() {
  return encoded("png", side, side, 3, noise(side * side * 3));
}

EncodedImage noisy_jpeg() {
  return encoded("jpg", side, side, 3, noise(side * side * 3));
}

/// The rows from `first` to `end` of two images are equal.
bool same_rows(const Texels& a, const Texels& b, size_t first, size_t end) {
  const auto row = [](const Texels& texels, size_t y) {
    return texels.rgba.begin() + static_cast<ptrdiff_t>(4 * y * texels.width);
  };
  return std::equal(row(a, first), row(a, end), row(b, first));
}

TEST(Damaged, JpegWithBytesThatTheDecoderSkipsIsWhole) {
  const EncodedImage whole = noisy_jpeg();
  const Bytes rubbish = {1, 2, 3};  // between the first two segments, where a marker should be
  const size_t second = 4 + (size_t{whole.bytes[4]} << 8 | whole.bytes[5]);
  EncodedImage between = whole;
  between.bytes.insert(between.bytes.begin() + static_cast<ptrdiff_t>(second), rubbish.begin(), rubbish.end());
  const DecodedTexels decoded = decode_image(between);
  EXPECT_EQ(decoded.texels.rgba, decode_image(whole).texels.rgba);
  // Once, in one line, without the name that the decoder was given.
  EXPECT_EQ(decoded.damage.rfind("Corrupt JPEG data: 3 extraneous bytes before marker 0x", 0), 0u);
  EXPECT_EQ(decoded.damage.size(), std::string("Corrupt JPEG data: 3 extraneous bytes before marker 0xdb").size());
  EXPECT_EQ(decode_image(whole).damage, "");
}

TEST(Damaged, JpegThatIsCutKeepsWhatIsThere) {
  const EncodedImage whole = noisy_jpeg();
  EncodedImage cut = whole;
  cut.bytes.resize(whole.bytes.size() / 2);
  const DecodedTexels half = decode_image(cut);
  EXPECT_EQ(half.damage, "JPEG is cut short (" + std::to_string(cut.bytes.size()) + " bytes)");
  // A row less than the first blocks: colours reach over their edge.
  EXPECT_TRUE(same_rows(half.texels, decode_image(whole).texels, 0, side / 4 - 1));
  EncodedImage ended = cut;  // ends as a JPEG does, but has half of its blocks
  ended.bytes.insert(ended.bytes.end(), {0xFF, 0xD9});
  EXPECT_EQ(decode_image(ended).damage, "Corrupt JPEG data: premature end of data segment");
}

TEST(Damaged, PngWithAWrongChecksumIsWhole) {
  const EncodedImage whole = noisy_png();
  const Texels expected = decode_image(whole).texels;
  EncodedImage data = whole;
  const size_t idat = chunk_at(whole.bytes, "IDAT");
  const size_t size = size_t{whole.bytes[idat + 2]} << 8 | whole.bytes[idat + 3];
  data.bytes[idat + 8 + size] ^= 1;
  const DecodedTexels decoded = decode_image(data);
  EXPECT_EQ(decoded.damage, "PNG is damaged: the checksum of chunk IDAT at byte " + std::to_string(idat) + " is wrong");
  EXPECT_EQ(decoded.texels.rgba, expected.rgba);

  const DecodedTexels text = decode_image(with_chunk(whole, chunk("tEXt", {'a', 0, 'b'}, false)));
  EXPECT_NE(text.damage.find("the checksum of chunk tEXt"), std::string::npos);
  EXPECT_EQ(text.texels.rgba, expected.rgba);
  EXPECT_EQ(decode_image(with_chunk(whole, chunk("tEXt", {'a', 0, 'b'}))).damage, "");
}

TEST(Damaged, PngLosesATransparencyThatIsDamagedAsInItsLibrary) {
  const EncodedImage red = encoded("png", 1, 1, 3, {255, 0, 0});
  const Bytes transparent = {0, 255, 0, 0, 0, 0};  // that colour has no alpha
  EXPECT_EQ(decode_image(with_chunk(red, chunk("tRNS", transparent))).texels.rgba, (Bytes{255, 0, 0, 0}));
  const DecodedTexels wrong = decode_image(with_chunk(red, chunk("tRNS", transparent, false)));
  EXPECT_EQ(wrong.texels.rgba, (Bytes{255, 0, 0, 255}));
  EXPECT_NE(wrong.damage.find("the checksum of chunk tRNS"), std::string::npos);
  const DecodedTexels odd = decode_image(with_chunk(red, chunk("tRNS", {0, 255})));
  EXPECT_EQ(odd.texels.rgba, (Bytes{255, 0, 0, 255}));
  EXPECT_EQ(odd.damage, "PNG is damaged: chunk tRNS has a wrong size or place (2)");
}

TEST(Damaged, PngThatIsCutRepeatsItsLastRow) {
  const EncodedImage whole = noisy_png();
  const Texels expected = decode_image(whole).texels;
  EncodedImage cut = whole;
  cut.bytes.resize(whole.bytes.size() / 2);
  const DecodedTexels half = decode_image(cut);
  EXPECT_EQ(half.damage, "PNG is cut short (" + std::to_string(cut.bytes.size()) + " bytes)");
  EXPECT_TRUE(same_rows(half.texels, expected, 0, side / 3));
  const size_t row = 4 * side;
  const auto last = half.texels.rgba.end() - static_cast<ptrdiff_t>(row);
  EXPECT_TRUE(std::equal(last, half.texels.rgba.end(), last - static_cast<ptrdiff_t>(row)));
  EXPECT_FALSE(same_rows(half.texels, expected, side - 1, side));
  EncodedImage tail = whole;  // all rows, but neither their checksum nor an end
  tail.bytes.resize(tail.bytes.size() - 20);
  EXPECT_EQ(decode_image(tail).texels.rgba, expected.rgba);
}

TEST(Damaged, PngWithRubbishInItsDataKeepsTheRowsBefore) {
  const EncodedImage whole = noisy_png();
  EncodedImage broken = whole;
  const size_t idat = chunk_at(whole.bytes, "IDAT");
  std::fill_n(broken.bytes.begin() + static_cast<ptrdiff_t>(idat + 8 + side * side * 2), 64, 0xFF);
  const DecodedTexels decoded = decode_image(broken);
  EXPECT_NE(decoded.damage, "");
  EXPECT_TRUE(same_rows(decoded.texels, decode_image(whole).texels, 0, side / 2));
}

TEST(Damaged, FilesWithoutAPictureAreErrorsOfOneLine) {
  EncodedImage claims = encoded("jpg", 8192, 8192, 1, Bytes(size_t{8192} * 8192, 128));
  claims.bytes.resize(700);  // headers and a little of the scan
  EXPECT_EQ(decode_error(claims), "test: image: JPEG is cut short (700 bytes)");
  EncodedImage head = noisy_png();
  head.bytes.resize(chunk_at(head.bytes, "IDAT") + 12);
  EXPECT_NE(decode_error(head), "");
  EXPECT_EQ(decode_error(head).find('\n'), std::string::npos);
}

/// A triangle that shows an image.
GltfBuilder showing(const Bytes& image, const char* type) {
  GltfBuilder gltf = one_triangle();
  gltf.json["images"] = {{{"bufferView", gltf.add_view(image)}, {"mimeType", type}, {"name", "bark"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

TEST(Damaged, ImagesAreNamedInAWarningOrWhereThatIsStrictInAnError) {
  EncodedImage cut = noisy_jpeg();
  cut.bytes.resize(cut.bytes.size() - 2);
  const GltfBuilder gltf = showing(cut.bytes, "image/jpeg");
  const std::string size = std::to_string(cut.bytes.size());
  Report report;
  Warnings warnings;
  bake(gltf.import(), {}, Progress(false), report, warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find(
                "scene.gltf: images: JPEG is cut short (" + size +
                " bytes): the part that can be decoded is baked; --strict refuses such images (image 0 'bark')"),
            std::string::npos)
      << warnings.lines()[0];
  BakeSettings strict;
  strict.images.strict = true;
  std::string error;
  try {
    gltf.bake(strict);
  } catch (const Error& thrown) {
    error = thrown.what();
  }
  EXPECT_NE(error.find("scene.gltf: image 0 'bark': JPEG is cut short (" + size + " bytes), which --strict"),
            std::string::npos)
      << error;
}

TEST(Damaged, ChunksWhoseNameIsNoTextAreNamedWithACacheToo) {
  const EncodedImage odd = with_chunk(noisy_png(), chunk("\xF4"
                                                         "EXt",
                                                         {'a', 0, 'b'}, false));
  EXPECT_NE(decode_image(odd).damage.find("the checksum of chunk \\xf4EXt at byte"), std::string::npos);
  const GltfBuilder gltf = showing(odd.bytes, "image/png");
  Cache cache(scratch_folder() / "odd_chunk_cache");
  std::vector<std::string> first;
  for (int run = 0; run < 2; ++run) {  // made, and found
    Report report;
    Warnings warnings;
    bake(gltf.import(), {}, Progress(false), report, warnings, &cache);
    ASSERT_EQ(warnings.lines().size(), 1u);
    EXPECT_NE(warnings.lines()[0].find("chunk \\xf4EXt at byte"), std::string::npos) << warnings.lines()[0];
    if (run == 0) first = warnings.lines();
    EXPECT_EQ(warnings.lines(), first);
  }
}

/// Two images with the same damage, both in one material.
TEST(Damaged, EachOfSeveralImagesIsNamed) {
  const EncodedImage one = with_chunk(noisy_png(), chunk("tEXt", {'a', 0, 'b'}, false));
  EncodedImage other = one;
  other.bytes[other.bytes.size() - 1] ^= 1;  // of the end's checksum: another file with the same first damage
  const Json map = {{"index", 0}}, other_map = {{"index", 1}};
  const Json plain = {{"pbrMetallicRoughness", {{"baseColorTexture", map}, {"metallicRoughnessTexture", other_map}}}};
  const Json glossy = {{"diffuseTexture", map}, {"specularGlossinessTexture", other_map}};
  for (const Json& material : {plain, Json{{"extensions", {{"KHR_materials_pbrSpecularGlossiness", glossy}}}}}) {
    GltfBuilder gltf = showing(one.bytes, "image/png");
    gltf.append("images", {{"bufferView", gltf.add_view(other.bytes)}, {"mimeType", "image/png"}, {"name", "leaf"}});
    gltf.append("textures", {{"source", 1}});
    gltf.json["materials"] = {material};
    Cache cache(scratch_folder() / "damaged_cache");
    for (int run = 0; run < 2; ++run) {  // made, and found
      Report report;
      Warnings warnings;
      bake(gltf.import(), {}, Progress(false), report, warnings, &cache);
      ASSERT_EQ(warnings.lines().size(), 1u);
      EXPECT_NE(warnings.lines()[0].find("refuses such images (image 0 'bark', image 1 'leaf')"), std::string::npos)
          << warnings.lines()[0];
    }
  }
}

/// The second image of a conversion is named, and not the first.
TEST(Damaged, TheMirrorOfADiffuseImageIsNamed) {
  const EncodedImage damaged = with_chunk(noisy_png(), chunk("tEXt", {'a', 0, 'b'}, false));
  GltfBuilder gltf = showing(noisy_png().bytes, "image/png");
  gltf.append("images", {{"bufferView", gltf.add_view(damaged.bytes)}, {"mimeType", "image/png"}, {"name", "leaf"}});
  gltf.append("textures", {{"source", 1}});
  const Json glossy = {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 1}}}};
  gltf.json["materials"] = {{{"extensions", {{"KHR_materials_pbrSpecularGlossiness", glossy}}}}};
  Report report;
  Warnings warnings;
  bake(gltf.import(), {}, Progress(false), report, warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("(image 1 'leaf')"), std::string::npos) << warnings.lines()[0];
}

TEST(Damaged, MapsThatOnlyTellGlassAreNamedToo) {
  EncodedImage cut = noisy_jpeg();
  cut.bytes.resize(cut.bytes.size() - 2);
  GltfBuilder gltf = showing(cut.bytes, "image/jpeg");
  const Json transmission = {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}};
  gltf.json["materials"] = {{{"extensions", {{"KHR_materials_transmission", transmission}}}}};
  Report report;
  Warnings warnings;
  BakeSettings settings;
  bake(gltf.import(), settings, Progress(false), report, warnings);
  const std::vector<std::string> lines = warnings.lines();
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                          [](const std::string& line) { return line.find("JPEG is cut short") != std::string::npos; }),
            1);
  settings.images.strict = true;
  EXPECT_THROW(bake(gltf.import(), settings, Progress(false), report, warnings), Error);
}

TEST(Webp, IsDecodedToItsColours) {
  Bytes pixels;
  for (size_t i = 0; i < 16 * 16; ++i) pixels.insert(pixels.end(), {200, 100, 50});
  const Texels texels = decode_image(encoded("webp", 16, 16, 3, pixels)).texels;
  ASSERT_EQ(texels.width, 16u);
  EXPECT_NEAR(texels.rgba[0], 200, 3);  // lossy
  EXPECT_NEAR(texels.rgba[1], 100, 3);
  EXPECT_NEAR(texels.rgba[2], 50, 3);
  EXPECT_EQ(texels.rgba[3], 255);
}

/// 64x64, lossless: red 4x, green 4y, blue 40; alpha 64 in the left half, 255 in the right.
const Bytes lossless_webp = {0x52, 0x49, 0x46, 0x46, 0x4A, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50,
                             0x38, 0x4C, 0x3E, 0x00, 0x00, 0x00, 0x2F, 0x3F, 0xC0, 0x0F, 0x10, 0x09, 0x80, 0x20,
                             0x06, 0xFC, 0x4F, 0x1B, 0x88, 0xE8, 0x7F, 0xEA, 0x0B, 0x80, 0x20, 0xFC, 0xAF, 0x1B,
                             0x88, 0xE8, 0x7F, 0xEA, 0x50, 0xD0, 0xB6, 0x0D, 0xE3, 0x1D, 0xFE, 0xBC, 0xAB, 0x01,
                             0x18, 0x81, 0xA4, 0x2D, 0xDE, 0xF6, 0x0F, 0x8A, 0x40, 0x20, 0x49, 0x6D, 0xF2, 0xD5,
                             0x26, 0x00, 0x73, 0xD2, 0x6E, 0x27, 0xBD, 0x00, 0xAE, 0xFF, 0xDF, 0x00};
/// The same with a lossy colour, and its alpha in a chunk of its own.
const Bytes lossy_webp = {
    0x52, 0x49, 0x46, 0x46, 0x60, 0x01, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x58, 0x0A, 0x00, 0x00,
    0x00, 0x10, 0x00, 0x00, 0x00, 0x3F, 0x00, 0x00, 0x3F, 0x00, 0x00, 0x41, 0x4C, 0x50, 0x48, 0x15, 0x00, 0x00, 0x00,
    0x01, 0x0F, 0xF0, 0xA0, 0xFF, 0x88, 0x88, 0x20, 0x16, 0x4C, 0xE6, 0x2F, 0x1D, 0x43, 0x5F, 0x44, 0xFF, 0xA3, 0x0A,
    0xBE, 0x03, 0x00, 0x56, 0x50, 0x38, 0x20, 0x24, 0x01, 0x00, 0x00, 0xD0, 0x0A, 0x00, 0x9D, 0x01, 0x2A, 0x40, 0x00,
    0x40, 0x00, 0x3E, 0x19, 0x0A, 0x84, 0x41, 0xA1, 0x05, 0x83, 0x01, 0x00, 0x04, 0x00, 0x61, 0x2C, 0x80, 0x17, 0x66,
    0x6C, 0x78, 0x67, 0xF3, 0x2F, 0xC7, 0xBF, 0xC6, 0x3E, 0xA7, 0x3E, 0x70, 0xF0, 0x36, 0x4F, 0x9E, 0xA0, 0x3D, 0x00,
    0x62, 0x7F, 0xF3, 0xFF, 0xDD, 0x00, 0x86, 0x70, 0x57, 0xF2, 0x05, 0x77, 0x20, 0xEC, 0xA7, 0x0D, 0x0C, 0x6C, 0x54,
    0x3A, 0xC1, 0xA5, 0xE9, 0xB8, 0xA2, 0xE8, 0xB4, 0xB4, 0xB3, 0xC7, 0xFF, 0xFE, 0xC0, 0x91, 0xC6, 0xE4, 0x52, 0x7F,
    0xFF, 0xF9, 0xA5, 0x36, 0xF6, 0xF6, 0xE0, 0x7F, 0xFF, 0xDF, 0x00, 0x00, 0xFE, 0xFF, 0xFF, 0x2A, 0x4D, 0x14, 0xE2,
    0xF6, 0xD1, 0x1A, 0x1B, 0xF0, 0x5E, 0x7B, 0xD2, 0xDF, 0xFD, 0x27, 0xAB, 0x7E, 0xB2, 0xFF, 0x16, 0xBD, 0x10, 0x76,
    0xE3, 0x7B, 0x04, 0x77, 0x4C, 0x99, 0xE1, 0x32, 0xA4, 0x47, 0xDE, 0x20, 0xEC, 0xA0, 0x9F, 0x3C, 0x3F, 0x1E, 0xA7,
    0x97, 0x40, 0xE8, 0xE3, 0xF1, 0xA0, 0xF5, 0x37, 0xA2, 0x33, 0x45, 0x18, 0x9E, 0xF0, 0xBA, 0x84, 0x89, 0xC2, 0xDB,
    0x2A, 0x35, 0x5D, 0x44, 0x16, 0x36, 0xB5, 0x07, 0x1E, 0xCA, 0x37, 0xAB, 0xF4, 0x01, 0x29, 0x5E, 0x08, 0x67, 0x4B,
    0xAD, 0x87, 0xF1, 0xA0, 0xDC, 0xE3, 0xBF, 0xA7, 0x42, 0x95, 0x10, 0x4A, 0x91, 0x6A, 0xB1, 0xF5, 0xF0, 0x69, 0x6D,
    0xE0, 0xE7, 0x41, 0x97, 0xE6, 0x1D, 0x0D, 0x81, 0x44, 0xD5, 0xBF, 0x59, 0x32, 0x98, 0x6D, 0xEB, 0x0C, 0x00, 0x01,
    0x01, 0x60, 0x83, 0x08, 0x18, 0x71, 0x7F, 0xF6, 0xE8, 0x82, 0xA1, 0x30, 0x63, 0x1D, 0x8E, 0x92, 0xFC, 0xA1, 0x45,
    0x8E, 0x01, 0x73, 0xF7, 0x35, 0x4A, 0x34, 0x5A, 0x0F, 0x5E, 0x70, 0xEA, 0xCD, 0x72, 0xA9, 0xCD, 0x2B, 0x71, 0x69,
    0xCD, 0x38, 0xD1, 0xDA, 0x6D, 0x52, 0x93, 0x8A, 0xDF, 0xC3, 0xD0, 0x24, 0xD4, 0x2C, 0xBA, 0xB7, 0x1E, 0x99, 0xAA,
    0xEC, 0x8A, 0x09, 0xCF, 0xE3, 0x0A, 0xA7, 0x30, 0x78, 0x16, 0x32, 0xFA, 0x9E, 0x12, 0xCB, 0x50, 0x00, 0x00};

TEST(Webp, KeepsColoursThatItsAlphaHides) {
  for (const auto& [bytes, error] : {std::pair(lossless_webp, 0), std::pair(lossy_webp, 6)}) {
    const DecodedTexels decoded = decode_image({"", "test: image", bytes});
    EXPECT_EQ(decoded.damage, "");
    ASSERT_EQ(decoded.texels.rgba.size(), 4 * side * side);
    for (size_t y = 0; y < side; ++y) {
      for (size_t x = 0; x < side; ++x) {
        const uint8_t* texel = &decoded.texels.rgba[4 * (y * side + x)];
        EXPECT_NEAR(texel[0], static_cast<double>(4 * x), error);
        EXPECT_NEAR(texel[1], static_cast<double>(4 * y), error);
        EXPECT_NEAR(texel[2], 40, error);
        EXPECT_EQ(texel[3], x < side / 2 ? 64 : 255);
      }
    }
  }
}

TEST(Webp, IsTakenWhereTheTextureHasNoOtherImage) {
  for (const bool required : {false, true}) {
    GltfBuilder gltf = showing(lossless_webp, "image/webp");
    gltf.json["extensionsUsed"] = {"EXT_texture_webp"};
    if (required) gltf.json["extensionsRequired"] = {"EXT_texture_webp"};
    gltf.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    gltf.json["materials"][0]["alphaMode"] = "MASK";
    BakeSettings raw;
    raw.images.textures = TextureMode::raw;
    const pack::Contents pack = gltf.bake(raw);
    ASSERT_EQ(pack.images.size(), 1u);
    EXPECT_EQ(pack.images[0].width, side);
    EXPECT_EQ(pack.image_data.at(4 * (side - 1)), std::byte{252});
    EXPECT_EQ(pack.image_data.at(3), std::byte{64});
  }
}

TEST(Webp, ThatIsCutIsAnError) {
  EncodedImage cut{"", "test: image", lossless_webp};
  for (size_t size = 4; size < lossless_webp.size() - 1; ++size) {
    cut.bytes.resize(lossless_webp.size());
    std::copy(lossless_webp.begin(), lossless_webp.end(), cut.bytes.begin());
    cut.bytes.resize(size);
    EXPECT_EQ(decode_error(cut).rfind("test: image: ", 0), 0u) << size;
  }
}

}  // namespace
}  // namespace chandelier::baker::test
