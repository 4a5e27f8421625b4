// SPDX-License-Identifier: Apache-2.0
// What a caller hands over, checked, as the runtime's own types.
#pragma once

#include <stdexcept>
#include <vector>

#include "frame/render_settings.h"
#include "pack_schema.h"
#include "predict/d_init_search.h"
#include "preview/chandelier_preview.h"

namespace chandelier::preview {

/// One line: where, what, and the offending value.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The lights that a bake would keep, each with the range that it would have.
struct Lights {
  std::vector<pack::Light> lights;
  std::vector<uint32_t> numbers;  // of each, among the caller's
};

// Each throws InputError.
Lights read_lights(const ChandelierPreviewLights& lights, float range_threshold_lx);
void check_size(uint32_t struct_bytes, size_t expected, const char* what);
Recipe read_recipe(const ChandelierPreviewSettings& settings);
Budget read_budget(const ChandelierPreviewSettings& settings);
/// Camera, size, and whether lights out of view count.
void read_camera(const ChandelierPreviewCamera& camera, RenderSettings& settings);

}  // namespace chandelier::preview
