// SPDX-License-Identifier: Apache-2.0
// The rules of a pack that concern more than one field.
#include "pack_checks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>

#include "image_format.h"
#include "pack_checks_animation.h"
#include "pack_checks_bvh.h"
#include "pack_checks_lights.h"
#include "pack_checks_text.h"
#include "pack_checks_voxels.h"
#include "pack_codec.h"
#include "pack_images.h"
#include "parallel.h"

namespace chandelier::pack {
namespace {

/// Below this a thread takes longer to start than to help.
constexpr size_t few_records = 100000;

/// How far from 1 the length of a direction may be, and from 0 the dot product of two that are perpendicular.
constexpr float direction_tolerance = 1e-3f;

float dot(const glm::vec3& a, const glm::vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

std::string direction_fault(const char* name, const glm::vec3& direction) {
  const float length = std::sqrt(dot(direction, direction));
  if (std::abs(length - 1.0f) <= direction_tolerance) return {};
  return std::string(".") + name + ": length " + text(length) + " is not 1";
}

std::string bounds_fault(const char* name, const glm::vec3& low, const glm::vec3& high) {
  for (int axis = 0; axis < 3; ++axis) {
    if (low[axis] > high[axis]) {
      return std::string(".") + name + "." + "xyz"[axis] + ": " + text(low[axis]) + " is above the maximum " +
             text(high[axis]);
    }
  }
  return {};
}

std::string multiple_fault(const char* name, uint64_t value, uint64_t of) {
  if (value % of == 0) return {};
  return std::string(".") + name + ": " + text(value) + " is not a multiple of " + text(of);
}

std::string fault(const Batch& batch) {
  if (std::string line = multiple_fault("first_index", batch.first_index, 3); !line.empty()) return line;
  if (std::string line = multiple_fault("index_count", batch.index_count, 3); !line.empty()) return line;
  return bounds_fault("bounds_min_ls", batch.bounds_min_ls, batch.bounds_max_ls);
}

std::string fault(const BatchInstance& draw) {
  return bounds_fault("bounds_min_ws", draw.bounds_min_ws, draw.bounds_max_ws);
}

std::string fault(const Image& image) {
  if (std::string line = multiple_fault("first_byte", image.first_byte, 16); !line.empty()) return line;
  const uint32_t full_chain = static_cast<uint32_t>(std::bit_width(std::max(image.width, image.height)));
  if (image.level_count > full_chain) {
    return ".level_count: " + text(uint64_t{image.level_count}) + " is above the " + text(uint64_t{full_chain}) +
           " levels of its size";
  }
  if (image.size_bytes != image_bytes(image)) {
    return ".size_bytes: " + text(image.size_bytes) + " where its levels have " + text(image_bytes(image));
  }
  if (image.codec == ImageCodec::raw) {
    if (image.stored_bytes == image.size_bytes) return {};
    return ".stored_bytes: " + text(image.stored_bytes) + " of a raw image of " + text(image.size_bytes) + " bytes";
  }
  if (image.stored_bytes == 0 || are_too_many(image.size_bytes, 1, image.stored_bytes)) {
    return ".size_bytes: " + text(image.size_bytes) + " are too many for the stored " + text(image.stored_bytes);
  }
  return {};
}

std::string fault(const Light& light) {
  if (light.inner_cone_cos < light.outer_cone_cos) {
    return ".inner_cone_cos: " + text(light.inner_cone_cos) + " is below outer_cone_cos " + text(light.outer_cone_cos);
  }
  return direction_fault("direction_ws", light.direction_ws);
}

std::string fault(const Camera& camera) {
  if (std::string line = direction_fault("forward_ws", camera.forward_ws); !line.empty()) return line;
  if (std::string line = direction_fault("up_ws", camera.up_ws); !line.empty()) return line;
  const float cosine = dot(camera.forward_ws, camera.up_ws);
  if (std::abs(cosine) <= direction_tolerance) return {};
  return ".up_ws: not perpendicular to forward_ws, their dot product is " + text(cosine);
}

template <typename Record>
std::string first_fault(const char* section, std::span<const Record> records) {
  for (size_t i = 0; i < records.size(); ++i) {
    if (std::string line = fault(records[i]); !line.empty()) return at(section, i) + line;
  }
  return {};
}

// The content of coded images is checked when they are decoded.
std::string texel_fault(const View& view) {
  uint64_t end = 0;
  for (size_t i = 0; i < view.images.size(); ++i) {
    const Image& image = view.images[i];
    if (image.first_byte < end) {
      return at("images", i) + ".first_byte: " + text(image.first_byte) + " is before the end of the image before, " +
             text(end);
    }
    end = image.first_byte + image.stored_bytes;
    if (image.format != ImageFormat::rgba16_sfloat || image.codec != ImageCodec::raw) continue;
    const std::string line = half_float_fault(view.image_data.subspan(image.first_byte, image.stored_bytes));
    if (!line.empty()) return at("images", i) + line;
  }
  return {};
}

// Checks what BatchInstance promises: runs of one material are as long as possible, and the opaque ones come first.
std::string order_fault(const View& view) {
  const auto place = [&](const BatchInstance& draw) {
    const uint32_t material = view.batches[draw.batch].material;
    return std::pair(view.materials[material].alpha_mode == AlphaMode::mask, material);
  };
  for (size_t i = 1; i < view.batch_instances.size(); ++i) {
    if (place(view.batch_instances[i]) < place(view.batch_instances[i - 1])) {
      return "batch_instances[" + text(i) + "]: not sorted by material, opaque ones first";
    }
  }
  return {};
}

}  // namespace

std::string light_fault(const Light& light) {
  Light alone = light;
  alone.voxel = alone.node = none;
  alone.name = {};
  BakeInfo info;  // validate() requires one
  info.batch_triangles = 1;
  View view;
  view.bake_info = &info;
  view.lights = {&alone, 1};
  const std::string line = validate(view, 1);
  return line.empty() ? fault(alone) : line.substr(at("lights", 0).size());
}

std::string check(const View& view, size_t most_threads) {
  if (std::string line = validate(view, most_threads); !line.empty()) return line;
  if (std::string line = bounds_fault("bounds_min_ws", view.bake_info->bounds_min_ws, view.bake_info->bounds_max_ws);
      !line.empty()) {
    return "bake_info" + line;
  }
  if (view.indices.size() % 3 != 0) {
    return "indices: " + text(view.indices.size()) + " records are not a multiple of 3";
  }
  // Each of these relies on the rules above; the first fault in this order is returned.
  const std::function<std::string()> rules[] = {
      [&] { return first_fault("batches", view.batches); },
      [&] { return first_fault("batch_instances", view.batch_instances); },
      [&] { return order_fault(view); },
      [&] { return first_fault("images", view.images); },
      [&] { return texel_fault(view); },
      [&] { return first_fault("lights", view.lights); },
      [&] { return light_fault(view); },
      [&] { return animation_fault(view); },
      [&] { return bvh_fault(view); },
      [&] { return voxel_fault(view); },
      [&] { return first_fault("cameras", view.cameras); },
  };
  std::array<std::string, std::size(rules)> faults;
  const auto apply = [&](size_t i) { faults[i] = rules[i](); };
  if (view.triangle_bvh.size() + view.voxel_indices.size() < few_records) {
    for (size_t i = 0; i < faults.size(); ++i) apply(i);
  } else {
    parallel_for(faults.size(), most_threads, apply);
  }
  const auto first = std::ranges::find_if(faults, [](const std::string& line) { return !line.empty(); });
  return first == faults.end() ? std::string() : *first;
}

std::string half_float_fault(std::span<const std::byte> texels) {
  for (size_t i = 0; i + 1 < texels.size(); i += 2) {
    uint16_t bits = 0;
    std::memcpy(&bits, &texels[i], sizeof(bits));
    if (is_half_texel(bits)) continue;
    return ": half float " + text(uint64_t{i / 2}) + " is negative or not finite (" + text(uint64_t{bits}) + ")";
  }
  return {};
}

}  // namespace chandelier::pack
