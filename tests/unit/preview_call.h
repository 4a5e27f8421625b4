// SPDX-License-Identifier: Apache-2.0
// A call of chandelier_preview_select(): random lights, settings, and everything that it takes and gives.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <random>
#include <string>
#include <vector>

#include "preview/chandelier_preview.h"

namespace chandelier::test {

struct Random {
  explicit Random(uint32_t seed) : bits(seed) {}
  uint32_t any() { return static_cast<uint32_t>(bits()); }
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(bits() % count); }
  bool once_in(uint32_t count) { return below(count) == 0; }
  float uniform(float from, float to) { return from + (to - from) * static_cast<float>(bits() >> 8) * 0x1p-24f; }

  std::mt19937 bits;
};

struct Record {
  std::array<float, 3> position{};
  uint8_t type = 0;
  std::array<float, 3> direction{0.0f, -1.0f, 0.0f};
  float intensity = 1.0f;
  std::array<float, 3> color{1.0f, 1.0f, 1.0f};
  float range_m = 0.0f;
  uint8_t flags = 0;
  float radius_m = 0.0f;
  float spot_outer_rad = 0.5f;
  uint8_t priority = 128;
  int32_t group = -1;
};

// What a call takes and gives. Its columns are parts of records that lie one after the other, with a byte between.
struct Call {
  static constexpr size_t stride = sizeof(Record) + 1;

  explicit Call(std::vector<Record> given) : records(std::move(given)), bytes(1 + records.size() * stride) {
    const auto count = static_cast<uint32_t>(records.size());
    const auto column = [&](size_t offset) -> ChandelierPreviewColumn { return {bytes.data() + 1 + offset, stride}; };
    lights = {.struct_bytes = sizeof lights,
              .count = count,
              .position = column(offsetof(Record, position)),
              .direction = column(offsetof(Record, direction)),
              .type = column(offsetof(Record, type)),
              .intensity = column(offsetof(Record, intensity)),
              .color = column(offsetof(Record, color)),
              .range_m = column(offsetof(Record, range_m)),
              .radius_m = column(offsetof(Record, radius_m)),
              .spot_outer_rad = column(offsetof(Record, spot_outer_rad)),
              .flags = column(offsetof(Record, flags)),
              .priority = column(offsetof(Record, priority)),
              .group = column(offsetof(Record, group))};
    chandelier_preview_defaults(&settings);
    camera = {.struct_bytes = sizeof camera,
              .eye_ws = {0, 0, 12},
              .forward_ws = {0, 0, -1},
              .up_ws = {0, 1, 0},
              .yfov_rad = 1.0f,
              .znear_m = 0.05f,
              .width_px = 1280,
              .height_px = 720};
    centers.assign(count, 77);
    ranges.assign(count, -1.0f);
    over_budget.assign(count, 77);
    clusters.assign(count, {});
    result = {.struct_bytes = sizeof result,
              .capacity = count,
              .center_of_light = centers.data(),
              .range_of_light_m = ranges.data(),
              .over_budget_of_light = over_budget.data(),
              .clusters = clusters.data()};
  }
  Call(const Call&) = delete;

  int32_t select() {
    for (size_t i = 0; i < records.size(); ++i) std::memcpy(bytes.data() + 1 + i * stride, &records[i], sizeof(Record));
    std::array<char, 256> text{};
    const int32_t status = chandelier_preview_select(&lights, &settings, &camera, &result, text.data(), text.size());
    error = text.data();
    return status;
  }

  std::vector<Record> records;
  std::vector<char> bytes;
  ChandelierPreviewLights lights{};
  ChandelierPreviewSettings settings{};
  ChandelierPreviewCamera camera{};
  ChandelierPreviewResult result{};
  std::vector<uint32_t> centers;
  std::vector<float> ranges;
  std::vector<uint8_t> over_budget;
  std::vector<ChandelierPreviewCluster> clusters;
  std::string error;
};

inline std::vector<Record> random_lights(Random& random, uint32_t count) {
  std::vector<Record> records(count);
  const bool have_radii = random.once_in(3);
  for (Record& record : records) {
    record.position = {random.uniform(-6, 6), random.uniform(-2, 2), random.uniform(-6, 6)};
    record.type = static_cast<uint8_t>(random.once_in(8) ? 2 : random.below(2));
    const glm::vec3 way = glm::normalize(
        glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) + glm::vec3(0, 0, 1e-3f));
    record.direction = {way.x, way.y, way.z};
    record.intensity = random.once_in(20) ? 0.0f : random.uniform(0.1f, 3.0f);
    record.color = {random.uniform(0, 1), random.uniform(0.1f, 1), random.uniform(0, 1)};
    record.range_m = random.once_in(2) ? 0.0f : random.uniform(1, 8);
    record.radius_m = have_radii && random.once_in(3) ? random.uniform(0, 0.2f) : 0.0f;
    record.spot_outer_rad = random.uniform(0.05f, 1.57f);
    record.flags = static_cast<uint8_t>(random.once_in(4) ? random.below(8) : 0);
    record.priority = static_cast<uint8_t>(random.once_in(3) ? random.below(256) : 128);
    record.group = random.once_in(5) ? static_cast<int32_t>(random.below(3)) : -1;
  }
  return records;
}

inline void random_settings(Random& random, Call& call) {
  call.settings.select = random.once_in(6) ? 0 : 1;
  call.settings.distance_scaling = random.below(3);
  call.settings.dynamic_lights = random.below(2);
  call.settings.face_size_px = 64u << random.below(4);
  call.settings.d_init_m = random.once_in(5) ? 0.0f : std::exp2(random.uniform(-3, 3));
  call.settings.z_far_m = random.uniform(5, 60);
  call.settings.max_shadow_maps = random.once_in(2) ? 0 : 1 + random.below(30);
  if (random.once_in(3)) call.settings.max_shadow_bytes = (1 + random.below(40)) * uint64_t{1} << 20;
  call.camera.sees_all = random.once_in(4);
  for (float& part : call.camera.eye_ws) part = random.uniform(-8, 8);
}

}  // namespace chandelier::test
