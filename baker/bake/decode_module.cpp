// SPDX-License-Identifier: Apache-2.0
// chandelier_images.so: PNG, JPEG and WebP through OpenImageIO.
#include "decode_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string_view>

namespace {

using chandelier::baker::DecodedImage;
using chandelier::baker::ImageFormat;

/// A name by which OpenImageIO finds its reader.
const char* name_of(ImageFormat format) {
  switch (format) {
    case ImageFormat::png:
      return "image.png";
    case ImageFormat::jpeg:
      return "image.jpg";
    default:
      return "image.webp";
  }
}

/// The first line of OpenImageIO's message (it repeats itself), without the file name that it was given and without a
/// fixed prefix.
std::string first_line(const std::string& text, ImageFormat format) {
  constexpr std::string_view no_news = "JPEG error: ";
  std::string line = text.substr(0, text.find('\n'));
  if (line.starts_with(no_news)) line.erase(0, no_news.size());
  const std::string name = std::string(" (\"") + name_of(format) + "\")";
  if (line.ends_with(name)) line.resize(line.size() - name.size());
  return line.empty() ? "unknown" : line;
}

DecodedImage decode(const std::vector<uint8_t>& file, ImageFormat format, int64_t max_size) {
  DecodedImage out;
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // as stored, not premultiplied
  OIIO::Filesystem::IOMemReader memory(const_cast<uint8_t*>(file.data()), file.size());
  void* proxy = &memory;  // among the hints: the JPEG reader forgets open()'s own argument
  hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(name_of(format), &hints, &memory);
  if (!input) {
    out.fault = first_line(OIIO::geterror(), format);
    return out;
  }
  input->threads(1);  // images are decoded side by side already
  const OIIO::ImageSpec& spec = input->spec();
  out.width = spec.width;
  out.height = spec.height;
  out.channels = spec.nchannels;
  const auto in_range = [](int64_t value, int64_t most) { return value >= 1 && value <= most; };
  if (!in_range(out.width, max_size) || !in_range(out.height, max_size) || !in_range(out.channels, 4)) return out;
  out.values.resize(static_cast<size_t>(out.width * out.height * out.channels));
  const bool read = input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, out.values.data());
  // After damage, libjpeg fills the rest with grey and only warns. The reader keeps the warning as its error.
  if (!read) {
    out.fault = first_line(input->geterror(), format);
  } else if (input->has_error()) {
    out.damage = first_line(input->geterror(), format);
  }
  return out;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const chandelier::baker::DecodeFunction chandelier_decode_image =
    decode;
