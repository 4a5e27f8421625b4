// SPDX-License-Identifier: Apache-2.0
// The cache entries of images: the results of one encoded image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../cache.h"
#include "../scene.h"
#include "images.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// Texels in the format of the pack.
struct StoredTexels {
  pack::Image record;
  std::vector<uint8_t> bytes;
  uint64_t texels = 0;         // of all levels
  uint64_t squared_error = 0;  // error of the compression, as in Blocks
  uint64_t values = 0;
};

/// The results of all requests for one encoded image.
struct MadeImages {
  std::vector<StoredTexels> images;
  std::vector<size_t> of_request;   // for each request, an index into `images`
  std::vector<std::string> damage;  // of each file, as in SceneTexels; the only result if there is an error
  std::string error;
};

/// The name of the entry of an image with these requests, in this order.
std::string image_entry(const Scene& scene, uint32_t image, const std::vector<ImageRequest>& requests,
                        const ImageSettings& settings);

/// False if the cache has no such entry, or if its number of files or requests differs.
bool load_images(Cache& cache, const std::string& entry, size_t source_count, size_t request_count, MadeImages& made);
void store_images(Cache& cache, const std::string& entry, const MadeImages& made);

}  // namespace chandelier::baker
