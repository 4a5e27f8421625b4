// SPDX-License-Identifier: Apache-2.0
// The entry is a pack with only images. Its notes map requests to images, and hold the loss of compression.
#include "image_cache.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "decode.h"
#include "pack_images.h"

namespace chandelier::baker {
namespace {

using Json = nlohmann::json;

/// The fault of an entry, or an empty text.
std::string read_entry(const CacheEntry& entry, size_t source_count, size_t request_count, MadeImages& made) {
  const pack::View& view = entry.pack.view();
  const Json notes = Json::parse(entry.notes);
  made.damage = notes.at("damage").get<std::vector<std::string>>();
  made.of_request = notes.at("of_request").get<std::vector<size_t>>();
  const Json& images = notes.at("images");
  if (made.damage.size() != source_count || made.of_request.size() != request_count ||
      images.size() != view.images.size())
    return "has other images";
  for (const size_t number : made.of_request) {
    if (number >= images.size()) return "has other images";
  }
  for (size_t i = 0; i < images.size(); ++i) {
    StoredTexels& out = made.images.emplace_back();
    out.record = view.images[i];
    const pack::Texels texels = pack::texels_of(view, static_cast<uint32_t>(i));
    const auto* bytes = reinterpret_cast<const uint8_t*>(texels.bytes().data());
    out.bytes.assign(bytes, bytes + texels.bytes().size());
    out.texels = images[i].at("texels").get<uint64_t>();
    out.squared_error = images[i].at("squared_error").get<uint64_t>();
    out.values = images[i].at("values").get<uint64_t>();
  }
  return {};
}

void add_bytes(CacheKey& key, const Scene& scene, uint32_t image) {
  if (image == no_index) return key.add_text({});
  const std::vector<uint8_t>& bytes = scene.images[image].bytes;
  key.add_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void add_image(CacheKey& key, const Scene& scene, uint32_t image) {
  const std::optional<SpecularGlossiness>& from = scene.images[image].converted_from;
  key.add(from.has_value());
  if (!from) return add_bytes(key, scene, image);
  const auto& [diffuse_factor, specular_factor, glossiness_factor, diffuse, specular_glossiness] = *from;
  for (const glm::vec3& factor : {diffuse_factor, specular_factor}) {
    for (int c = 0; c < 3; ++c) key.add(factor[c]);
  }
  key.add(glossiness_factor);
  for (const uint32_t source : {diffuse, specular_glossiness}) {
    key.add(source == no_index);
    add_bytes(key, scene, source);
  }
}

}  // namespace

std::string image_entry(const Scene& scene, uint32_t image, const std::vector<ImageRequest>& requests,
                        const ImageSettings& settings) {
  const auto& [textures, max_size, strict] = settings;  // strict: the entry says what is damaged
  CacheKey key("image");
  key.add_text(decoder_code());
  add_image(key, scene, image);
  key.add(textures);
  key.add(max_size);
  for (const auto& [number, use, alpha_cutoff] : requests) {
    key.add(use);
    key.add(alpha_cutoff);
  }
  return key.name();
}

bool load_images(Cache& cache, const std::string& name, size_t source_count, size_t request_count, MadeImages& made) {
  const std::unique_ptr<CacheEntry> entry = cache.load(name);
  if (!entry) return false;
  std::string fault;
  try {
    fault = read_entry(*entry, source_count, request_count, made);
  } catch (const Json::exception&) {
    fault = "has damaged notes";
  } catch (const pack::Error&) {
    fault = "has a damaged image";
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
    record.stored_bytes = image.bytes.size();
    record.codec = pack::ImageCodec::raw;
    const auto* bytes = reinterpret_cast<const std::byte*>(image.bytes.data());
    contents.image_data.insert(contents.image_data.end(), bytes, bytes + image.bytes.size());
    contents.image_data.resize((contents.image_data.size() + 15) / 16 * 16);
    images.push_back({{"texels", image.texels}, {"squared_error", image.squared_error}, {"values", image.values}});
  }
  const Json notes = {{"of_request", made.of_request}, {"images", images}, {"damage", made.damage}};
  const std::string text = notes.dump(-1, ' ', false, Json::error_handler_t::replace);  // never throws
  cache.store(name, pack::view_of(contents), text);
}

}  // namespace chandelier::baker
