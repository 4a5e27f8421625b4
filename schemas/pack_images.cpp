// SPDX-License-Identifier: Apache-2.0
#include "pack_images.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "image_format.h"
#include "pack_checks_text.h"
#include "pack_codec.h"
#include "pack_file.h"

namespace chandelier::pack {
namespace {

constexpr size_t alignment = 16;  // of first_byte

std::span<const std::byte> stored_of(const View& view, const Image& image) {
  return view.image_data.subspan(image.first_byte, image.stored_bytes);
}

[[noreturn]] void fail(const View& view, size_t image, const std::string& what) {
  const StringRef& name = view.images[image].name;
  const auto* text = reinterpret_cast<const char*>(view.strings.data()) + name.offset_bytes;
  throw Error(at("images", image) + " (" + std::string(text, name.size_bytes) + ")" + what);
}

bool lie_one_after_another(const View& view) {
  uint64_t end = 0;
  for (const Image& image : view.images) {
    const uint64_t size = view.image_data.size();
    if (image.first_byte < end || image.first_byte > size || image.stored_bytes > size - image.first_byte) return false;
    end = image.first_byte + image.stored_bytes;
  }
  return true;
}

std::unique_ptr<std::byte[]> room_for(const View& view, uint32_t image) {
  const uint64_t bytes = view.images[image].size_bytes;
  try {
    return std::make_unique_for_overwrite<std::byte[]>(bytes);
  } catch (const std::bad_alloc&) {
    fail(view, image, ": not enough memory to decode it (" + text(bytes) + " bytes)");
  }
}

}  // namespace

std::vector<Texels> texels_of(const View& view, uint32_t first, uint32_t count, size_t most_threads) {
  std::vector<Texels> texels;
  std::vector<Coded> coded;
  std::vector<uint32_t> number;  // of each of `coded`
  for (uint32_t i = first; i < first + count; ++i) {
    const Image& image = view.images[i];
    if (image.codec == ImageCodec::raw) {
      texels.emplace_back(stored_of(view, image));
      continue;
    }
    std::unique_ptr<std::byte[]> decoded = room_for(view, i);
    coded.push_back({Codec::zstd, 1, stored_of(view, image), {decoded.get(), image.size_bytes}});
    number.push_back(i);
    texels.emplace_back(std::move(decoded), image.size_bytes);
  }
  const std::vector<std::string> faults = decode_all(coded, most_threads);
  for (size_t i = 0; i < coded.size(); ++i) {
    const Image& image = view.images[number[i]];
    if (!faults[i].empty()) fail(view, number[i], ".codec: " + std::string(name_of(image.codec)) + ": " + faults[i]);
    if (image.format != ImageFormat::rgba16_sfloat) continue;
    if (const std::string line = half_float_fault(coded[i].records); !line.empty()) fail(view, number[i], line);
  }
  return texels;
}

Texels texels_of(const View& view, uint32_t image) {
  return std::move(texels_of(view, image, 1).front());
}

void check_images(const View& view, size_t most_threads) {
  for (uint32_t i = 0; i < view.images.size(); ++i) texels_of(view, i, 1, most_threads);  // one at a time in memory
}

EncodedImages encode_images(const View& view, size_t most_threads) {
  EncodedImages out;
  if (!lie_one_after_another(view)) return out;
  std::vector<std::span<const std::byte>> raw;
  for (const Image& image : view.images) {
    raw.push_back(image.codec == ImageCodec::raw ? stored_of(view, image) : std::span<const std::byte>());
  }
  const std::vector<Encoded> encoded = encode_images(raw, most_threads);
  for (size_t i = 0; i < raw.size(); ++i) {
    Image& image = out.images.emplace_back(view.images[i]);
    std::span<const std::byte> stored = stored_of(view, image);
    if (encoded[i].codec == Codec::zstd) {
      image.codec = ImageCodec::zstd;
      stored = encoded[i].bytes;
    }
    out.image_data.resize((out.image_data.size() + alignment - 1) / alignment * alignment);
    image.first_byte = out.image_data.size();
    image.stored_bytes = stored.size();
    out.image_data.insert(out.image_data.end(), stored.begin(), stored.end());
  }
  return out;
}

}  // namespace chandelier::pack
