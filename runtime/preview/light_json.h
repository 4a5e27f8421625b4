// SPDX-License-Identifier: Apache-2.0
// chandelier-lights' input and output: the columns and records of chandelier_preview.h as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "preview/chandelier_preview.h"

namespace chandelier::preview {

/// What chandelier_preview_select() is given. The columns point into the vectors, which moving leaves in place.
struct Request {
  ChandelierPreviewLights lights{};
  ChandelierPreviewSettings settings{};
  ChandelierPreviewCamera camera{};
  std::vector<std::vector<float>> floats;
  std::vector<std::vector<uint8_t>> bytes;
  std::vector<int32_t> groups;
  uint32_t zero_ranges = 0;  // lights with an end whose range_m is 0, which stands for none
};

/// Throws std::runtime_error, one line: where, what, and the offending value.
Request read_request(const nlohmann::json& json);

nlohmann::ordered_json to_json(const ChandelierPreviewResult& result, uint32_t light_count);

}  // namespace chandelier::preview
