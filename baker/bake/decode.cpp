// SPDX-License-Identifier: Apache-2.0
// Checks PNG, JPEG and WebP files and has them decoded by chandelier_images.so, which is loaded for the first of them.
#include "decode.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "../error.h"
#include "decode_module.h"
#include "jpeg.h"
#include "pack_schema.h"
#include "png.h"
#include "webp.h"

namespace chandelier::baker {
namespace {

using Bytes = std::vector<uint8_t>;

bool starts_with(const std::vector<uint8_t>& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin(),
                                                    [](char a, uint8_t b) { return static_cast<uint8_t>(a) == b; });
}

bool is_png(const EncodedImage& image) {
  return starts_with(image.bytes, "\x89PNG");
}
bool is_jpeg(const EncodedImage& image) {
  return starts_with(image.bytes, "\xFF\xD8\xFF");
}
bool is_webp(const EncodedImage& image) {
  return starts_with(image.bytes, "RIFF");
}

/// Formats that glTF extensions bring.
std::string name_of_format(const EncodedImage& image) {
  if (starts_with(image.bytes, "\xABKTX 20")) return " but KTX2";
  if (starts_with(image.bytes, "DDS ")) return " but DDS";
  return "";
}

/// RGBA from 1 to 4 channels; one or two are grey, or grey and alpha.
std::vector<uint8_t> to_rgba(std::vector<uint8_t>&& in, size_t texels, size_t channels) {
  if (channels == 4) return std::move(in);
  std::vector<uint8_t> out(4 * texels, 255);
  for (size_t i = 0; i < texels; ++i) {
    const uint8_t* from = in.data() + i * channels;
    for (size_t c = 0; c < 3; ++c) out[4 * i + c] = channels < 3 ? from[0] : from[c];
    if (channels == 2) out[4 * i + 3] = from[1];
  }
  return out;
}

/// The module's path, relative to the program, in the build folder and where it is installed.
std::filesystem::path module_path() {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return (folder / CHANDELIER_MODULE_FOLDER / "chandelier_images.so").lexically_normal();
}

DecodeFunction load_decoder() {
  const std::filesystem::path path = module_path();
  void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* decoder = module ? dlsym(module, decode_symbol) : nullptr;
  if (!decoder) fail(path.string(), "cannot be loaded, so no image can be decoded: " + shortened(dlerror(), 200));
  return *static_cast<const DecodeFunction*>(decoder);
}

DecodedImage decode_file(const Bytes& bytes, ImageFormat format, const std::string& where) {
  static const DecodeFunction decode = load_decoder();
  DecodedImage decoded = decode(bytes, format, pack::max_image_size);
  if (decoded.fault.empty()) check_image_size(decoded.width, decoded.height, where);
  if (decoded.fault.empty() && decoded.values.empty()) {
    decoded.fault = "not 1 to 4 channels (" + std::to_string(decoded.channels) + ")";
  }
  return decoded;
}

/// OpenImageIO always multiplies a WebP's colours by its alpha. So the colours are decoded from a copy without alpha.
DecodedImage decode_webp(const EncodedImage& image) {
  DecodedImage decoded = decode_file(image.bytes, ImageFormat::webp, image.where);
  if (decoded.channels != 4 || !decoded.fault.empty()) return decoded;
  const DecodedImage opaque = decode_file(webp_without_alpha(image.bytes), ImageFormat::webp, image.where);
  if (!opaque.fault.empty() || opaque.channels != 3 || opaque.values.size() / 3 != decoded.values.size() / 4) {
    decoded.fault = "its alpha channel cannot be separated from its colours";
    return decoded;
  }
  for (size_t i = 0; i < opaque.values.size() / 3; ++i) {
    std::copy_n(opaque.values.begin() + static_cast<ptrdiff_t>(3 * i), 3,
                decoded.values.begin() + static_cast<ptrdiff_t>(4 * i));
  }
  return decoded;
}

void refuse_empty(const EncodedImage& image, const std::string& damage) {
  if (!damage.empty() && has_no_picture(claimed_size(image), image.bytes.size())) fail(image.where, damage);
}

/// `damage` gets the faults of the file as a whole.
DecodedImage decode_any(const EncodedImage& image, std::string& damage) {
  if (is_png(image)) {
    const Bytes png = essential_png(image.bytes, image.where, damage);
    refuse_empty(image, damage);
    return decode_file(png, ImageFormat::png, image.where);
  }
  if (is_webp(image)) return decode_webp(image);
  if (!is_jpeg(image)) {
    const std::string size = std::to_string(image.bytes.size());
    fail(image.where, "is neither PNG, JPEG nor WebP" + name_of_format(image) + " (" + size + " bytes)");
  }
  if (!is_whole_jpeg(image.bytes)) damage = "JPEG is cut short (" + std::to_string(image.bytes.size()) + " bytes)";
  refuse_empty(image, damage);
  return decode_file(image.bytes, ImageFormat::jpeg, image.where);
}

}  // namespace

void check_image_size(int64_t width, int64_t height, const std::string& where) {
  if (width >= 1 && height >= 1 && width <= pack::max_image_size && height <= pack::max_image_size) return;
  fail(where, "size is out of range, 1 to " + std::to_string(pack::max_image_size) + " (" + std::to_string(width) +
                  "x" + std::to_string(height) + ")");
}

DecodedTexels decode_image(const EncodedImage& image) {
  std::string damage;
  DecodedImage decoded = decode_any(image, damage);
  if (damage.empty()) damage = decoded.damage;
  if (!decoded.fault.empty()) {
    fail(image.where, damage.empty() ? "cannot be decoded: " + shortened(decoded.fault, 200) : damage);
  }
  refuse_empty(image, damage);
  const size_t texels = size_t(decoded.width) * size_t(decoded.height);
  return {{static_cast<uint32_t>(decoded.width), static_cast<uint32_t>(decoded.height),
           to_rgba(std::move(decoded.values), texels, static_cast<size_t>(decoded.channels))},
          printable(shortened(damage, 200))};  // it may hold bytes of the file
}

const std::string& decoder_code() {
  static const std::string code = [] {
    std::ifstream file(module_path(), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  return code;
}

ClaimedSize claimed_size(const EncodedImage& image) {
  if (is_png(image)) return png_size(image.bytes);
  return is_jpeg(image) ? jpeg_size(image.bytes) : is_webp(image) ? webp_size(image.bytes) : ClaimedSize();
}

}  // namespace chandelier::baker
