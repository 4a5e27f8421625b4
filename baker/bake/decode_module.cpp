// SPDX-License-Identifier: Apache-2.0
// chandelier_images.so: PNG and JPEG through OpenImageIO.
#include "decode_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace {

using chandelier::baker::DecodedImage;

DecodedImage decode(const std::vector<std::uint8_t>& file, bool is_png, std::int64_t max_size) {
  DecodedImage out;
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // as stored, not premultiplied
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(file.data()), file.size());
  void* proxy = &memory;  // among the hints: the JPEG reader forgets open()'s own argument
  hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(is_png ? "image.png" : "image.jpg", &hints, &memory);
  if (!input) {
    out.fault = OIIO::geterror();
    if (out.fault.empty()) out.fault = "unknown";
    return out;
  }
  input->threads(1);  // images are decoded side by side already
  const OIIO::ImageSpec& spec = input->spec();
  out.width = spec.width;
  out.height = spec.height;
  out.channels = spec.nchannels;
  const auto in_range = [](std::int64_t value, std::int64_t most) { return value >= 1 && value <= most; };
  if (!in_range(out.width, max_size) || !in_range(out.height, max_size) || !in_range(out.channels, 4)) return out;
  out.values.resize(static_cast<std::size_t>(out.width * out.height * out.channels));
  // libjpeg goes on with grey after damage, and only warns: the reader keeps its first warning as its error.
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, out.values.data()) || input->has_error()) {
    out.fault = input->geterror();
    if (out.fault.empty()) out.fault = "unknown";
  }
  return out;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const chandelier::baker::DecodeFunction chandelier_decode_image =
    decode;
