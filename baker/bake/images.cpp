// SPDX-License-Identifier: Apache-2.0
// Images in parallel; the result does not depend on the number of threads.
#include "images.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

#include "../error.h"
#include "block_compress.h"
#include "decode.h"
#include "decode_scene.h"
#include "image_cache.h"
#include "image_format.h"

namespace chandelier::baker {
namespace {

/// Decoded texels in memory at a time, apart from an image that alone has more; each takes up to 16 bytes.
constexpr uint64_t texels_at_once = uint64_t{32} << 20;

struct Formats {
  pack::ImageFormat raw, blocks;
  BlockFormat fit;
};

Formats formats_of(ImageUse use) {
  switch (use) {
    case ImageUse::color:
      return {pack::ImageFormat::rgba8_srgb, pack::ImageFormat::bc1_srgb, BlockFormat::bc1};
    case ImageUse::masked_color:
      return {pack::ImageFormat::rgba8_srgb, pack::ImageFormat::bc3_srgb, BlockFormat::bc3};
    case ImageUse::data:
      return {pack::ImageFormat::rgba8_unorm, pack::ImageFormat::bc1_unorm, BlockFormat::bc1};
    default:
      return {pack::ImageFormat::rgba8_unorm, pack::ImageFormat::bc5_unorm, BlockFormat::bc5};
  }
}

/// Compresses into blocks if asked for and if they are smaller: a single texel is not.
StoredTexels stored(std::vector<Texels>&& levels, ImageUse use, TextureMode mode) {
  const Formats formats = formats_of(use);
  StoredTexels out;
  out.record.width = levels[0].width;
  out.record.height = levels[0].height;
  out.record.level_count = static_cast<uint32_t>(levels.size());
  out.record.format = formats.raw;
  pack::Image in_blocks = out.record;
  in_blocks.format = formats.blocks;
  const bool compress = mode == TextureMode::bc && image_bytes(in_blocks) < image_bytes(out.record);
  if (compress) out.record.format = formats.blocks;
  out.record.size_bytes = image_bytes(out.record);
  out.bytes.reserve(out.record.size_bytes);
  for (Texels& level : levels) {
    out.texels += level.rgba.size() / 4;
    if (compress) {
      const Blocks blocks = compress_blocks(level, formats.fit);
      out.bytes.insert(out.bytes.end(), blocks.bytes.begin(), blocks.bytes.end());
      out.squared_error += blocks.squared_error;
      out.values += blocks.values;
    } else {
      out.bytes.insert(out.bytes.end(), level.rgba.begin(), level.rgba.end());
    }
    level.rgba = {};
  }
  return out;
}

bool is_opaque(const Texels& texels) {
  for (size_t i = 3; i < texels.rgba.size(); i += 4) {
    if (texels.rgba[i] != 255) return false;
  }
  return true;
}

/// The requests of images that are the same, byte by byte.
struct Job {
  uint32_t image;                // the first of them
  std::vector<size_t> requests;  // their numbers
};

/// For each image the first that is the same, which may be itself.
class SameImages {
 public:
  explicit SameImages(const Scene& scene) : scene_(scene) {}

  uint32_t first(uint32_t image) {
    if (image == no_index) return no_index;
    const EncodedImage& encoded = scene_.images[image];
    if (!encoded.converted_from) {
      const std::string_view content(reinterpret_cast<const char*>(encoded.bytes.data()), encoded.bytes.size());
      return first_of_bytes_.try_emplace(content, image).first->second;
    }
    SpecularGlossiness from = *encoded.converted_from;
    from.diffuse = first(from.diffuse);
    from.specular_glossiness = first(from.specular_glossiness);
    for (const auto& [known, number] : converted_) {
      if (known == from) return number;
    }
    converted_.emplace_back(from, image);
    return image;
  }

 private:
  const Scene& scene_;
  std::unordered_map<std::string_view, uint32_t> first_of_bytes_;
  std::vector<std::pair<SpecularGlossiness, uint32_t>> converted_;
};

std::vector<Job> jobs_of(const std::vector<ImageRequest>& requests, const Scene& scene) {
  std::vector<Job> jobs;
  SameImages same(scene);
  std::unordered_map<uint32_t, size_t> job_of;
  for (size_t i = 0; i < requests.size(); ++i) {
    const auto [it, added] = job_of.try_emplace(same.first(requests[i].image), jobs.size());
    if (added) jobs.push_back({requests[i].image, {}});
    jobs[it->second].requests.push_back(i);
  }
  return jobs;
}

/// The parameters of a request: requests with equal ones share the result.
struct Wish {
  ImageUse use;
  float alpha_cutoff;
  bool operator==(const Wish&) const = default;
};

MadeImages make_images_of(const Job& job, const Scene& scene, const std::vector<ImageRequest>& requests,
                          const ImageSettings& settings) {
  MadeImages made;
  try {
    const SceneTexels decoded = decode_image(scene, job.image);
    made.damage = decoded.damage;
    const bool opaque = is_opaque(decoded.color);
    std::vector<Wish> wishes;
    for (const size_t number : job.requests) {
      const ImageRequest& request = requests[number];
      const bool masked = request.use == ImageUse::masked_color;
      const Wish wish = masked && opaque ? Wish{ImageUse::color, 0} : Wish{request.use, request.alpha_cutoff};
      const auto known = std::find(wishes.begin(), wishes.end(), wish);
      made.of_request.push_back(static_cast<size_t>(known - wishes.begin()));
      if (known != wishes.end()) continue;
      wishes.push_back(wish);
      made.images.push_back(
          stored(mip_chain(Texels(decoded.as(wish.use)), wish.use, wish.alpha_cutoff, settings.max_size), wish.use,
                 settings.textures));
    }
  } catch (const Error& error) {
    made.error = error.what();  // kept, so that the first error in order is reported, not the first in time
  }
  return made;
}

/// Loads results from the cache; makes and stores those that it does not have.
MadeImages find_or_make_images(const Job& job, const Scene& scene, const std::vector<ImageRequest>& requests,
                               const ImageSettings& settings, Cache& cache) {
  if (!cache.is_on()) return make_images_of(job, scene, requests, settings);
  std::vector<ImageRequest> asked;
  for (const size_t number : job.requests) asked.push_back(requests[number]);
  const std::string entry = image_entry(scene, job.image, asked, settings);
  MadeImages made;
  size_t sources = 0;
  for_each_source(scene, job.image, [&](uint32_t) { ++sources; });
  if (load_images(cache, entry, sources, asked.size(), made)) return made;
  made = make_images_of(job, scene, requests, settings);
  if (made.error.empty()) store_images(cache, entry, made);
  return made;
}

/// How many jobs still need the bytes of each image.
std::vector<uint32_t> count_users(const std::vector<Job>& jobs, const Scene& scene) {
  std::vector<uint32_t> users(scene.images.size(), 0);
  for (const Job& job : jobs) for_each_source(scene, job.image, [&](uint32_t source) { ++users[source]; });
  return users;
}

/// Runs jobs in parallel, as many as memory allows. Removes the bytes from the scene.
std::vector<MadeImages> run(const std::vector<Job>& jobs, const std::vector<ImageRequest>& requests, Scene& scene,
                            const ImageSettings& settings, const Progress& progress, Cache& cache, Warnings& warnings) {
  std::vector<MadeImages> made(jobs.size());
  std::vector<uint32_t> users = count_users(jobs, scene);
  for (size_t first = 0; first < jobs.size();) {
    progress.next("making images, " + std::to_string(first) + " of " + std::to_string(jobs.size()) + " done");
    size_t end = first;
    for (uint64_t texels = 0; end < jobs.size() && (end == first || texels < texels_at_once); ++end) {
      texels += claimed_texels(scene, jobs[end].image);
    }
    tbb::parallel_for(first, end,
                      [&](size_t i) { made[i] = find_or_make_images(jobs[i], scene, requests, settings, cache); });
    for (; first < end; ++first) {
      if (!made[first].error.empty()) throw Error(made[first].error);
      report_damage(scene, jobs[first].image, made[first].damage, settings.strict, warnings);
      for_each_source(scene, jobs[first].image, [&](uint32_t source) {
        if (--users[source] == 0) scene.images[source].bytes = {};
      });
    }
  }
  return made;
}

uint32_t add_image(StoredTexels&& image, const std::string& name, Strings& strings, pack::Contents& pack) {
  image.record.first_byte = pack.image_data.size();
  image.record.stored_bytes = image.bytes.size();
  image.record.codec = pack::ImageCodec::raw;
  image.record.name = strings.add(name);
  pack.images.push_back(image.record);
  const auto* data = reinterpret_cast<const std::byte*>(image.bytes.data());
  pack.image_data.insert(pack.image_data.end(), data, data + image.bytes.size());
  pack.image_data.resize((pack.image_data.size() + 15) / 16 * 16);
  image.bytes = {};
  return fit_u32(pack.images.size() - 1, "images");
}

void count_images(const std::vector<MadeImages>& made, size_t requests, PassReport& report) {
  uint64_t images = 0, texels = 0, squared_error = 0, values = 0, damaged = 0;
  for (const MadeImages& each : made) {
    images += each.images.size();
    damaged += std::any_of(each.damage.begin(), each.damage.end(), [](const auto& what) { return !what.empty(); });
    for (const StoredTexels& image : each.images) {
      texels += image.texels;
      squared_error += image.squared_error;
      values += image.values;
    }
  }
  report.count("images", static_cast<double>(images));
  report.count("decoded", static_cast<double>(made.size()));
  report.count("shared", static_cast<double>(requests - made.size()));  // uses that needed no decoding of their own
  report.count("damaged", static_cast<double>(damaged));
  report.count("texels", static_cast<double>(texels));
  if (squared_error == 0) return;
  report.count("psnr_db",
               10 * std::log10(255.0 * 255.0 * static_cast<double>(values) / static_cast<double>(squared_error)));
}

}  // namespace

void make_images(Scene& scene, const std::vector<ImageRequest>& requests, const ImageSettings& settings,
                 const Progress& progress, Cache& cache, PassReport& report, Warnings& warnings, Strings& strings,
                 pack::Contents& pack) {
  const std::vector<Job> jobs = jobs_of(requests, scene);
  std::vector<MadeImages> made = run(jobs, requests, scene, settings, progress, cache, warnings);
  count_images(made, requests.size(), report);
  size_t bytes = 0;
  for (const MadeImages& each : made) {
    for (const StoredTexels& image : each.images) bytes += (image.bytes.size() + 15) / 16 * 16;
  }
  pack.image_data.reserve(bytes);
  std::vector<uint32_t> image_of_request(requests.size());
  for (size_t i = 0; i < jobs.size(); ++i) {
    std::vector<uint32_t> numbers;
    for (StoredTexels& image : made[i].images) {
      numbers.push_back(add_image(std::move(image), scene.images[jobs[i].image].name, strings, pack));
    }
    for (size_t r = 0; r < jobs[i].requests.size(); ++r) {
      image_of_request[jobs[i].requests[r]] = numbers[made[i].of_request[r]];
    }
  }
  for (pack::Texture& texture : pack.textures) texture.image = image_of_request[texture.image];
  for (EncodedImage& image : scene.images) image.bytes = {};
}

}  // namespace chandelier::baker
