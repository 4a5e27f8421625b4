// SPDX-License-Identifier: Apache-2.0
// Textures as shaders see them: block formats, transformed coordinates, what is cut out of shadows, unlit materials.
#include <cmath>
#include <filesystem>
#include <glm/gtc/packing.hpp>

#include "gpu_test.h"
#include "shading/occlusion.h"

namespace chandelier::test {
namespace {

constexpr uint32_t size_px = 32;
constexpr uint32_t red = 0xFF0000FFu, green = 0xFF00FF00u, blue = 0xFFFF0000u, white = 0xFFFFFFFFu;

class TexturesTest : public GpuTest {
 protected:
  /// A square seen from the front that fills the picture.
  Picture draw_square(Scene& scene, const pack::Material& material, float exposure_ev = 0) {
    scene.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(material));
    RenderSettings settings = settings_for(look({0, 0, 2}, {0, 0, 0}, 2 * std::atan(0.5f)), size_px, size_px, Recipe());
    settings.exposure_ev = exposure_ev;
    return draw(device(), scene, settings);
  }
  /// The square's colour at its uv.
  static glm::vec3 at_uv(const Picture& picture, float u, float v) {
    return radiance_at(picture, static_cast<uint32_t>(u * size_px), static_cast<uint32_t>(v * size_px));
  }
  static pack::Material unlit(uint32_t texture) {
    pack::Material material = plain_material(glm::vec3(1.0f));
    material.base_color_texture = texture;
    material.unlit = 1;
    return material;
  }
};

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-3f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

pack::Image four_by_four(pack::ImageFormat format) {
  return {.width = 4, .height = 4, .level_count = 1, .format = format};
}

template <typename T, size_t N>
std::span<const std::byte> bytes_of(const std::array<T, N>& values) {
  return std::as_bytes(std::span(values));
}

// Red and blue as end points; code 0 in the upper two rows, code 1 below.
constexpr std::array<uint8_t, 8> red_over_blue = {0x00, 0xF8, 0x1F, 0x00, 0x00, 0x00, 0x55, 0x55};

TEST_F(TexturesTest, ReadBc1) {
  for (const pack::ImageFormat format : {pack::ImageFormat::bc1_srgb, pack::ImageFormat::bc1_unorm}) {
    Scene scene;
    const Picture picture = draw_square(scene, unlit(scene.add_texture(four_by_four(format), bytes_of(red_over_blue))));
    expect_near(at_uv(picture, 0.5f, 0.2f), {1, 0, 0});
    expect_near(at_uv(picture, 0.5f, 0.8f), {0, 0, 1});
  }
}

TEST_F(TexturesTest, ReadBc3AndCutByItsAlpha) {
  std::array<uint8_t, 16> block{};
  block[0] = 255;  // alpha end points 255 and 0; code 1 in the last eight texels: the lower half is cut out
  for (const size_t i : {5u, 6u, 7u}) block[i] = i == 5 ? 0x49 : i == 6 ? 0x92 : 0x24;
  std::copy(red_over_blue.begin(), red_over_blue.end(), block.begin() + 8);
  Scene scene;
  pack::Material material = unlit(scene.add_texture(four_by_four(pack::ImageFormat::bc3_srgb), bytes_of(block)));
  material.alpha_mode = pack::AlphaMode::mask;
  const Picture picture = draw_square(scene, material);
  expect_near(at_uv(picture, 0.5f, 0.2f), {1, 0, 0});
  expect_near(at_uv(picture, 0.5f, 0.8f), {0, 0, 0});
}

TEST_F(TexturesTest, TakeANormalsZFromXAndYInBothFormats) {
  std::array<uint8_t, 16> block{};
  block[0] = block[1] = 204;  // x 0.6
  block[8] = block[9] = 128;  // y 0
  Picture pictures[2];
  for (int raw = 0; raw < 2; ++raw) {
    Scene scene;
    scene.lights.push_back(directional_light({0, 0, -1}, 1.0f));
    pack::Material material = plain_material(glm::vec3(1.0f));
    material.normal_texture = raw ? scene.add_texture(1, 1, {0xFF1280CCu})  // another z, which is not looked at
                                  : scene.add_texture(four_by_four(pack::ImageFormat::bc5_unorm), bytes_of(block));
    Recipe recipe;
    recipe.shade = Shade::lambert;
    scene.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(material));
    pictures[raw] = draw(device(), scene, settings_for(look({0, 0, 2}, {0, 0, 0}, 0.9f), size_px, size_px, recipe));
  }
  const float z = std::sqrt(1.0f - 0.36f);
  expect_near(at_uv(pictures[0], 0.5f, 0.5f), glm::vec3(z / 3.14159265f), 2e-3f);
  expect_near(at_uv(pictures[0], 0.5f, 0.5f), at_uv(pictures[1], 0.5f, 0.5f), 1e-5f);
}

TEST_F(TexturesTest, ReadEveryLevelOfBlocksThatHangOverTheEdge) {
  // 6 by 6 texels are 4 blocks, then 3 by 3 and 1 by 1 one each: 6 in all, each level of one colour.
  std::vector<std::byte> bytes;
  for (int block = 0; block < 6; ++block) {
    const uint8_t high = block < 4 ? 0xF8 : block == 4 ? 0x07 : 0x00, low = block < 4 ? 0x00 : block == 4 ? 0xE0 : 0x1F;
    for (const uint8_t byte : {low, high, low, high, uint8_t{0}, uint8_t{0}, uint8_t{0}, uint8_t{0}})
      bytes.push_back(std::byte{byte});
  }
  const glm::vec3 expected[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const float texels_a_pixel[] = {0.2f, 2.1f, 8.0f};
  for (int level = 0; level < 3; ++level) {
    Scene scene;
    const float scale = texels_a_pixel[level] * size_px / 6;
    const uint32_t texture =
        scene.add_texture({.width = 6, .height = 6, .level_count = 3, .format = pack::ImageFormat::bc1_unorm}, bytes,
                          {glm::vec3(scale, 0, 0), glm::vec3(0, scale, 0)});
    expect_near(at_uv(draw_square(scene, unlit(texture)), 0.4f, 0.4f), expected[level]);
  }
}

TEST_F(TexturesTest, TransformCoordinates) {
  const std::vector<uint32_t> texels = {red, green, blue, white};
  const auto corner = [&](const UvTransform& transform, float u, float v) {
    Scene scene;
    return at_uv(draw_square(scene, unlit(scene.add_texture(2, 2, texels, transform))), u, v);
  };
  expect_near(corner(uv_identity, 0.25f, 0.25f), {1, 0, 0});
  expect_near(corner(uv_identity, 0.75f, 0.25f), {0, 1, 0});
  // Offset by half an image.
  expect_near(corner({glm::vec3(1, 0, 0.5f), glm::vec3(0, 1, 0)}, 0.25f, 0.25f), {0, 1, 0});
  // Scaled: the whole square shows the first texel.
  expect_near(corner({glm::vec3(0.5f, 0, 0), glm::vec3(0, 0.5f, 0)}, 0.75f, 0.75f), {1, 0, 0});
  // A quarter turn as KHR_texture_transform has it, (u, v) to (v, 1 - u) with its offset.
  const UvTransform turned = {glm::vec3(0, 1, 0), glm::vec3(-1, 0, 1)};
  expect_near(corner(turned, 0.25f, 0.25f), {0, 0, 1});
  expect_near(corner(turned, 0.75f, 0.75f), {0, 1, 0});
}

// A sheet over a floor, lit from above: its left half is cut out, or by its transform the right one.
TEST_F(TexturesTest, CutShadowsWithTransformedCoordinates) {
  for (const bool moved : {false, true}) {
    Scene scene;
    scene.lights.push_back(directional_light({0, -1, 0}, 1.0f));
    scene.add(level_square({0, 0, 0}, 4.0f), scene.add_material(plain_material(glm::vec3(1.0f))));
    pack::Material sheet = plain_material(glm::vec3(1.0f));
    const UvTransform transform = moved ? UvTransform{glm::vec3(-1, 0, 1), glm::vec3(0, 1, 0)} : uv_identity;
    sheet.base_color_texture = scene.add_texture(2, 1, {0x00FFFFFFu, 0xFFFFFFFFu}, transform);
    sheet.alpha_mode = pack::AlphaMode::mask;
    sheet.double_sided = 1;
    scene.add(level_square({0, 3, 0}, 1.0f), scene.add_material(sheet));
    const RenderSettings settings = settings_for(look({0, 2, 6}, {0, 0, 0}, 0.6f), 64, 48, Recipe());
    const Picture picture = draw(device(), scene, settings);
    int dark_left = 0, dark_right = 0, lit = 0;
    for (uint32_t y = 26; y < 48; ++y) {
      for (uint32_t x = 0; x < 64; ++x) {
        const glm::vec3 p = floor_point(settings, x, y);
        const bool inside = std::abs(p.z) < 0.8f && std::abs(p.x) > 0.2f && std::abs(p.x) < 0.8f;
        if (!inside) continue;
        const bool dark = radiance_at(picture, x, y).r < 0.01f;
        (dark ? p.x < 0 ? dark_left : dark_right : lit) += 1;
      }
    }
    EXPECT_GT(lit, 10);
    EXPECT_GT(moved ? dark_left : dark_right, 10);
    EXPECT_EQ(moved ? dark_right : dark_left, 0);
  }
}

// Stripes that run away from the eye: a square filter blurs them where the floor is seen at a slant, a long one does
// not.
TEST_F(TexturesTest, AnisotropyKeepsWhatRunsAwayFromTheEyeSharp) {
  constexpr uint32_t side = 64;
  std::vector<uint32_t> texels;
  for (uint32_t level_side = side; level_side > 0; level_side /= 2) {
    const uint32_t stripe = level_side / 16;  // texels; below one, all is grey
    for (uint32_t i = 0; i < level_side * level_side; ++i)
      texels.push_back(stripe == 0 ? 0xFF808080u : i % level_side / stripe % 2 ? white : 0xFF000000u);
  }
  Scene scene;
  const pack::Image image{.width = side, .height = side, .level_count = 7, .format = pack::ImageFormat::rgba8_unorm};
  const uint32_t texture = scene.add_texture(image, std::as_bytes(std::span(texels)));
  scene.filter_textures();
  scene.add(level_square({0, 0, 0}, 4.0f), scene.add_material(unlit(texture)));
  const pack::File pack = scene.open();
  const World world(pack);
  const RenderSettings settings = settings_for(look({0, 0.15f, 4.5f}, {0, 0, 0}, 0.5f), 64, 64, Recipe());
  const auto contrast = [&](std::optional<float> anisotropy) {
    Renderer renderer(device(), world, {.anisotropy = anisotropy});
    renderer.draw(settings);
    const Picture picture = renderer.read_back();
    float sum = 0.0f;
    for (uint32_t x = 1; x < 64; ++x)
      sum += std::abs(radiance_at(picture, x, 30).r - radiance_at(picture, x - 1, 30).r);
    return sum;
  };
  EXPECT_GT(contrast(8.0f), 1.5f * contrast(1.0f));
  EXPECT_EQ(contrast({}), contrast(device().is_software ? 1.0f : 8.0f));
}

TEST_F(TexturesTest, UnlitIsShownAsItIsAndStillCastsAShadow) {
  const glm::vec3 color(0.2f, 0.5f, 0.8f);
  pack::Material material = plain_material(color);
  material.unlit = 1;
  material.emissive = glm::vec3(3.0f);  // not asked
  for (const float exposure_ev : {-4.0f, 0.0f, 4.0f}) {
    Scene scene;
    scene.lights.push_back(directional_light({0, 0, -1}, 100.0f));
    const Picture picture = draw_square(scene, material, exposure_ev);
    expect_near(at_uv(picture, 0.5f, 0.5f), color, 1e-6f);
    const uint8_t* shown = &picture.shown[4 * (size_px / 2 * size_px + size_px / 2)];
    const float expected[] = {124, 188, 231};  // sRGB: 0.4845, 0.7354, 0.9063
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], expected[c], 1);
  }
  Scene scene;
  scene.lights.push_back(directional_light({0, -1, 0}, 1.0f));
  scene.add(level_square({0, 0, 0}, 4.0f), scene.add_material(plain_material(glm::vec3(1.0f))));
  scene.add(level_square({0, 3, 0}, 1.0f), scene.add_material(material));
  const Picture picture = draw(device(), scene, settings_for(look({0, 2, 6}, {0, 0, 0}, 0.6f), 64, 48, Recipe()));
  EXPECT_LT(radiance_at(picture, 32, 24).r, 0.01f);  // under the sheet
  EXPECT_GT(radiance_at(picture, 4, 24).r, 0.1f);    // beside it
}

// ---- Half floats

// Two by two texels of red, green, blue and alpha, then one: mean or not, it is another level.
constexpr std::array<float, 20> half_values = {4,    0.25f, 1000, 1, 0,  0.5f, 65504, 0.25f, 0.001f, 2,
                                               1.5f, 0.75f, 1,    1, 64, 0,    16,    8,     3,      1};

uint32_t add_half_texture(Scene& scene, const UvTransform& transform = uv_identity) {
  std::vector<uint16_t> halves;
  for (const float value : half_values) halves.push_back(glm::packHalf1x16(value));
  const pack::Image image{.width = 2, .height = 2, .level_count = 2, .format = pack::ImageFormat::rgba16_sfloat};
  return scene.add_texture(image, std::as_bytes(std::span(halves)), transform);
}

// What a half float holds of `half_values`.
glm::vec4 half_texel(size_t i) {
  glm::vec4 texel;
  for (size_t c = 0; c < 4; ++c)
    texel[static_cast<int>(c)] = glm::unpackHalf1x16(glm::packHalf1x16(half_values[4 * i + c]));
  return texel;
}

TEST_F(TexturesTest, UnlitHalfFloatsAreShownBeyondOne) {
  Scene scene;
  const Picture picture = draw_square(scene, unlit(add_half_texture(scene)));
  for (size_t i = 0; i < 4; ++i)
    EXPECT_EQ(at_uv(picture, i % 2 ? 0.75f : 0.25f, i / 2 ? 0.75f : 0.25f), glm::vec3(half_texel(i))) << i;
  Scene minified;
  const UvTransform many = {glm::vec3(2.0f * size_px, 0, 0), glm::vec3(0, 2.0f * size_px, 0)};
  EXPECT_EQ(at_uv(draw_square(minified, unlit(add_half_texture(minified, many))), 0.5f, 0.5f),
            glm::vec3(half_texel(4)));
}

TEST_F(TexturesTest, HalfFloatsAreFilteredLinearly) {
  Scene scene;
  const pack::Material material = unlit(add_half_texture(scene));
  scene.filter_textures();
  const Picture picture = draw_square(scene, material);
  // A pixel's middle is 1/64 from the middle between texels, of which each is half a picture wide.
  const float right = 0.5f + 1.0f / 32;
  const glm::vec3 expected = glm::mix(glm::vec3(half_texel(0)), glm::vec3(half_texel(1)), right);
  const glm::vec3 found = at_uv(picture, 0.5f, 0.1f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1.0f, 0.01f) << c;
}

// Radiance is emission, as bright as it is, and what a base colour of at most 1 reflects.
TEST_F(TexturesTest, HalfFloatsGlowAndReflect) {
  const glm::vec3 factor(2.0f, 1.0f, 0.5f);
  Scene scene;
  pack::Material material = plain_material(glm::vec3(1.0f));
  material.base_color_texture = material.emissive_texture = add_half_texture(scene);
  material.emissive = factor;
  scene.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(material));
  RenderSettings settings = settings_for(look({0, 0, 2}, {0, 0, 0}, 2 * std::atan(0.5f)), size_px, size_px, Recipe());
  settings.ambient = Ambient::constant(0.25f);
  const Picture picture = draw(device(), scene, settings);
  for (size_t i = 0; i < 4; ++i) {
    const glm::vec3 texel(half_texel(i));
    const glm::vec3 expected = factor * texel + 0.25f * glm::min(texel, 1.0f);
    const glm::vec3 found = at_uv(picture, i % 2 ? 0.75f : 0.25f, i / 2 ? 0.75f : 0.25f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-6f * expected[c]) << i << ", " << c;
  }
}

TEST_F(TexturesTest, HalfFloatsAreCutByTheirAlpha) {
  Scene scene;
  pack::Material material = unlit(add_half_texture(scene));
  material.alpha_mode = pack::AlphaMode::mask;
  const Picture picture = draw_square(scene, material);
  EXPECT_EQ(at_uv(picture, 0.25f, 0.25f), glm::vec3(half_texel(0)));
  EXPECT_EQ(at_uv(picture, 0.75f, 0.25f), glm::vec3(0.0f));  // alpha 0.25
  EXPECT_EQ(at_uv(picture, 0.25f, 0.75f), glm::vec3(half_texel(2)));
}

// ---- Images with a codec each

// Two quads with textures, one of a size that a codec makes smaller and one that stays raw.
Scene two_pictures() {
  std::vector<uint16_t> halves;
  for (uint32_t i = 0; i < 64 * 64; ++i)
    for (uint32_t c = 0; c < 4; ++c)
      halves.push_back(glm::packHalf1x16(c == 3 ? 1.0f : static_cast<float>(i / 512 + c)));
  Scene scene;
  const pack::Image image{.width = 64, .height = 64, .level_count = 1, .format = pack::ImageFormat::rgba16_sfloat};
  pack::Material left = plain_material(glm::vec3(1.0f)), right = left;
  left.unlit = right.unlit = 1;
  left.base_color_texture = scene.add_texture(image, std::as_bytes(std::span(halves)));
  right.base_color_texture = scene.add_texture(2, 2, {red, green, blue, white});
  scene.add(quad({-0.5f, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}), scene.add_material(left));
  scene.add(quad({0.5f, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}), scene.add_material(right));
  return scene;
}

TEST_F(TexturesTest, CodedImagesAreDrawnLikeRawOnes) {
  const RenderSettings settings =
      settings_for(look({0, 0, 2}, {0, 0, 0}, 2 * std::atan(0.5f)), size_px, size_px, Recipe());
  Picture pictures[2];
  for (const bool is_coded : {false, true}) {
    const pack::File pack = two_pictures().open(is_coded ? pack::Compression::smallest : pack::Compression::off);
    EXPECT_EQ(pack.view().images[0].codec, is_coded ? pack::ImageCodec::zstd : pack::ImageCodec::raw);
    EXPECT_EQ(pack.view().images[1].codec, pack::ImageCodec::raw);
    const World world(pack);
    Renderer renderer(device(), world);
    renderer.draw(settings);
    pictures[is_coded] = renderer.read_back();
  }
  EXPECT_EQ(pictures[0].radiance, pictures[1].radiance);
  EXPECT_EQ(at_uv(pictures[1], 0.25f, 0.55f), glm::vec3(4, 5, 6));
  EXPECT_EQ(at_uv(pictures[1], 0.9f, 0.1f), glm::vec3(0, 1, 0));
}

TEST_F(TexturesTest, AnImageThatCannotBeDecodedIsRefusedByName) {
  const pack::File good = two_pictures().open(pack::Compression::smallest);
  pack::Contents contents = two_pictures().contents();
  contents.images.assign(good.view().images.begin(), good.view().images.end());
  contents.image_data.assign(good.view().image_data.begin(), good.view().image_data.end());
  contents.image_data[contents.images[0].first_byte + 4] ^= std::byte{0x20};
  const std::string path = testing::TempDir() + "chandelier-damaged-image";
  pack::write(path, contents);
  const pack::File pack(path);
  std::filesystem::remove(path);
  const World world(pack);
  try {
    const Renderer renderer(device(), world);
    ADD_FAILURE() << "was drawn";
  } catch (const pack::Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("images[0] ().codec: zstd: ")) << error.what();
  }
}

// Four texels of occlusion, a square of none, an unlit one, and background: all stay apart from the light that is
// added.
TEST_F(TexturesTest, KeepOcclusionApartFromLight) {
  constexpr float strength = 0.75f;
  const std::array<uint32_t, 4> texels = {0xFF000000u, 0xFF000055u, 0xFF0000AAu, 0xFF0000FFu};
  Scene scene;
  scene.lights.push_back(directional_light({0, 0, -1}, 3.0f));
  pack::Material occluded = plain_material(glm::vec3(0.5f));
  occluded.occlusion_texture = scene.add_texture(2, 2, {texels.begin(), texels.end()});
  occluded.occlusion_strength = strength;
  pack::Material flat = plain_material(glm::vec3(0.5f));
  flat.unlit = 1;
  scene.add(quad({-1, 1, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(occluded));
  scene.add(quad({1, 1, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.add(quad({-1, -1, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(flat));
  Recipe recipe;
  recipe.shade = Shade::lambert;
  RenderSettings settings = settings_for(look({0, 0, 4}, {0, 0, 0}, 2 * std::atan(0.5f)), size_px, size_px, recipe);
  settings.ambient = Ambient::constant(0.25f);
  const Picture picture = draw(device(), scene, settings);
  const auto alpha = [&](uint32_t x, uint32_t y) { return picture.radiance[4 * (size_px * y + x) + 3]; };
  const float lit_only = at_uv(picture, 0.75f, 0.25f).r - 0.25f * 0.5f;
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t x = 4 + 8 * (i % 2), y = 4 + 8 * (i / 2);
    const float expected = 1.0f + strength * (static_cast<float>(texels[i] & 255u) / 255.0f - 1.0f);
    EXPECT_FALSE(is_unlit(alpha(x, y)));
    EXPECT_NEAR(occlusion_of_alpha(alpha(x, y)), expected, 2e-7f) << i;
    EXPECT_NEAR(radiance_at(picture, x, y).r, lit_only + 0.25f * 0.5f * expected, 1e-6f) << i;
  }
  EXPECT_EQ(alpha(24, 8), alpha_of_occlusion(1.0f));   // a material without a map
  EXPECT_EQ(alpha(24, 24), alpha_of_occlusion(1.0f));  // background
  EXPECT_TRUE(is_unlit(alpha(8, 24)));
}

}  // namespace
}  // namespace chandelier::test
