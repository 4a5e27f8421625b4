// SPDX-License-Identifier: Apache-2.0
// PNG and JPEG through OpenImageIO.
#include "decode.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <string_view>

#include "../error.h"
#include "jpeg.h"
#include "pack_schema.h"
#include "png.h"

namespace chandelier::baker {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool starts_with(const std::vector<std::uint8_t>& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

bool is_png(const EncodedImage& image) {
  return starts_with(image.bytes, "\x89PNG");
}
bool is_jpeg(const EncodedImage& image) {
  return starts_with(image.bytes, "\xFF\xD8\xFF");
}

/// Formats that glTF extensions bring.
std::string name_of_format(const EncodedImage& image) {
  if (starts_with(image.bytes, "\xABKTX 20")) return " but KTX2";
  if (starts_with(image.bytes, "RIFF")) return " but WebP";
  if (starts_with(image.bytes, "DDS ")) return " but DDS";
  return "";
}

/// RGBA from 1 to 4 channels; one or two are grey, or grey and alpha.
std::vector<std::uint8_t> to_rgba(std::vector<std::uint8_t>&& in, std::size_t texels, std::size_t channels) {
  if (channels == 4) return std::move(in);
  std::vector<std::uint8_t> out(4 * texels, 255);
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint8_t* from = in.data() + i * channels;
    for (std::size_t c = 0; c < 3; ++c) out[4 * i + c] = channels < 3 ? from[0] : from[c];
    if (channels == 2) out[4 * i + 3] = from[1];
  }
  return out;
}

}  // namespace

void check_image_size(std::int64_t width, std::int64_t height, const std::string& where) {
  if (width >= 1 && height >= 1 && width <= pack::max_image_size && height <= pack::max_image_size) return;
  fail(where, "size is out of range, 1 to " + std::to_string(pack::max_image_size) + " (" + std::to_string(width) +
                  "x" + std::to_string(height) + ")");
}

Texels decode_image(const EncodedImage& image) {
  if (!is_png(image) && !is_jpeg(image)) {
    const std::string size = std::to_string(image.bytes.size());
    fail(image.where, "is neither PNG nor JPEG" + name_of_format(image) + " (" + size + " bytes)");
  }
  if (is_jpeg(image)) check_jpeg(image.bytes, image.where);
  const std::vector<std::uint8_t> png = is_png(image) ? essential_png(image.bytes, image.where) : Bytes();
  const std::vector<std::uint8_t>& bytes = is_png(image) ? png : image.bytes;
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // as stored, not premultiplied
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  void* proxy = &memory;  // among the hints: the JPEG reader forgets open()'s own argument
  hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(is_png(image) ? "image.png" : "image.jpg", &hints, &memory);
  if (!input) fail(image.where, "cannot be decoded: " + shortened(OIIO::geterror(), 200));
  input->threads(1);  // images are decoded side by side already
  const OIIO::ImageSpec& spec = input->spec();
  check_image_size(spec.width, spec.height, image.where);
  if (spec.nchannels < 1 || spec.nchannels > 4) {
    fail(image.where, "cannot be decoded: not 1 to 4 channels (" + std::to_string(spec.nchannels) + ")");
  }
  const std::size_t texels = std::size_t(spec.width) * std::size_t(spec.height);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<std::uint8_t> values(texels * channels);
  // libjpeg goes on with grey after damage, and only warns: the reader keeps its first warning as its error.
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, values.data()) || input->has_error()) {
    fail(image.where, "cannot be decoded: " + shortened(input->geterror(), 200));
  }
  return {static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height),
          to_rgba(std::move(values), texels, channels)};
}

std::uint64_t claimed_texels(const EncodedImage& image) {
  return is_png(image) ? png_texels(image.bytes) : is_jpeg(image) ? jpeg_texels(image.bytes) : 0;
}

}  // namespace chandelier::baker
