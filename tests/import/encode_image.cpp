// SPDX-License-Identifier: Apache-2.0
// Image files made in tests.
#include "encode_image.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "bake/decode.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {

EncodedImage encoded(const char* extension, int width, int height, int channels, const std::vector<uint8_t>& pixels) {
  const std::filesystem::path path = scratch_folder() / (std::string("image.") + extension);
  const auto output = OIIO::ImageOutput::create(path.string());
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  EXPECT_TRUE(output && output->open(path.string(), spec));
  EXPECT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, pixels.data()));
  output->close();
  std::vector<uint8_t> bytes(std::filesystem::file_size(path));
  FILE* file = std::fopen(path.c_str(), "rb");
  EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
  std::fclose(file);
  return {"image", "test: image", bytes};
}

std::vector<uint8_t> noise(size_t count) {
  std::vector<uint8_t> out;
  for (uint32_t x = 1; out.size() < count; x = x * 1664525u + 1013904223u) out.push_back(static_cast<uint8_t>(x >> 24));
  return out;
}

std::string decode_error(const EncodedImage& image) {
  try {
    decode_image(image);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace chandelier::baker::test
