// SPDX-License-Identifier: Apache-2.0
// The entry is a pack with nothing but images; its notes say which request has which, and what compression lost.
#include "image_cache.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "decode.h"

namespace chandelier::baker {
namespace {

using Json = nlohmann::json;

/// What is wrong with an entry, or nothing.
std::string read_entry(const CacheEntry& entry, std::size_t request_count, MadeImages& made) {
  const pack::View& view = entry.pack.view();
  const Json notes = Json::parse(entry.notes);
  made.of_request = notes.at("of_request").get<std::vector<std::size_t>>();
  const Json& images = notes.at("images");
  if (made.of_request.size() != request_count || images.size() != view.images.size()) return "has other images";
  for (const std::size_t number : made.of_request) {
    if (number >= images.size()) return "has other images";
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    StoredTexels& out = made.images.emplace_back();
    out.record = view.images[i];
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(view.image_data.data() + out.record.first_byte);
    out.bytes.assign(bytes, bytes + out.record.size_bytes);
    out.texels = images[i].at("texels").get<std::uint64_t>();
    out.squared_error = images[i].at("squared_error").get<std::uint64_t>();
    out.values = images[i].at("values").get<std::uint64_t>();
  }
  return {};
}

}  // namespace

std::string image_entry(const EncodedImage& image, const std::vector<ImageRequest>& requests,
                        const ImageSettings& settings) {
  const auto& [textures, max_size] = settings;
  CacheKey key("image");
  key.add_text(decoder_code());
  key.add_text({reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size()});
  key.add(textures);
  key.add(max_size);
  for (const auto& [number, use, alpha_cutoff] : requests) {
    key.add(use);
    key.add(alpha_cutoff);
  }
  return key.name();
}

bool load_images(Cache& cache, const std::string& name, std::size_t request_count, MadeImages& made) {
  const std::unique_ptr<CacheEntry> entry = cache.load(name);
  if (!entry) return false;
  std::string fault;
  try {
    fault = read_entry(*entry, request_count, made);
  } catch (const Json::exception&) {
    fault = "has damaged notes";
  }
  if (fault.empty()) return true;
  made = {};
  cache.reject(name, fault);
  return false;
}

void store_images(Cache& cache, const std::string& name, const MadeImages& made) {
  pack::Contents contents;
  Json images = Json::array();
  for (const StoredTexels& image : made.images) {
    pack::Image& record = contents.images.emplace_back(image.record);
    record.name = {};
    record.first_byte = contents.image_data.size();
    const auto* bytes = reinterpret_cast<const std::byte*>(image.bytes.data());
    contents.image_data.insert(contents.image_data.end(), bytes, bytes + image.bytes.size());
    contents.image_data.resize((contents.image_data.size() + 15) / 16 * 16);
    images.push_back({{"texels", image.texels}, {"squared_error", image.squared_error}, {"values", image.values}});
  }
  const Json notes = {{"of_request", made.of_request}, {"images", images}};
  cache.store(name, pack::view_of(contents), notes.dump());
}

}  // namespace chandelier::baker
