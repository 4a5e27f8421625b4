// SPDX-License-Identifier: Apache-2.0
// A recipe: one answer for each stage of a frame, and its settings. A preset is a recipe with a name.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lights/light_clusters.h"
#include "lights/wall_test.h"

namespace chandelier {

enum class GBuffer : uint32_t { depth_normal_material };
enum class Select : uint32_t { per_light, light_clusters, error_driven };
enum class Lookup : uint32_t { all, tiles };
enum class Store : uint32_t { cube_array };
enum class Project : uint32_t { cube };
enum class Cull : uint32_t { none, light_frustum };
enum class Rasterize : uint32_t { multi_draw };
enum class Filter : uint32_t { hard, pcf, pcss, rays };
enum class Deliver : uint32_t { inlined, textures };
enum class Shade : uint32_t { ggx, lambert };

using lights::DistanceScaling;
using lights::DynamicLights;
using lights::WallTest;
/// Of the area light that stands for a light cluster: d_min, or as far as its members are from its centre.
enum class AreaRadius : uint32_t { d_min, spread };

struct Recipe {
  GBuffer g_buffer = GBuffer::depth_normal_material;
  Select select = Select::per_light;
  Lookup lookup = Lookup::tiles;
  Store store = Store::cube_array;
  Project project = Project::cube;
  Cull cull = Cull::light_frustum;
  Rasterize rasterize = Rasterize::multi_draw;
  Filter filter = Filter::hard;
  Deliver deliver = Deliver::inlined;
  Shade shade = Shade::ggx;

  float d_init_m = 0.5f;  // LightCluster §3.1.2, metres
  float z_far_m = 30.0f;  // LightCluster §5.4, metres
  DistanceScaling distance_scaling = DistanceScaling::grow;
  DynamicLights dynamic_lights = DynamicLights::cluster;
  AreaRadius area_radius = AreaRadius::d_min;  // LightCluster §3.2.2
  WallTest walls = WallTest::none;
  float stability = 0.0f;         // 0 to below 1: how much lights cling to RenderSettings::previous_centers
  float reference_share = 0.85f;  // as many clusters per light in view: the reference is drawn instead; above 1: never
  std::optional<uint32_t> max_maps;  // error-driven: as little error as so many maps allow, whatever d_init says
  std::optional<float> max_rmse;     // error-driven: as few maps as keep so much error of the shown picture
  uint32_t face_size_px = 512;       // width of one face of a cube
  uint64_t shadow_budget_bytes = uint64_t{1024} << 20;  // depth kept at a time; more maps are drawn in further rounds

  bool operator==(const Recipe&) const = default;
};

/// One stage of a frame and what it may be answered with, for options, help and reports.
struct StageChoices {
  std::string_view stage;     // "select"
  std::string_view question;  // "which lights get a shadow map?"
  std::span<const std::string_view> answers;
};

/// Every stage, in the order of the frame.
std::span<const StageChoices> stage_choices();
/// The name of this recipe's answer to stage `stage` (an index into stage_choices()).
std::string_view answer(const Recipe& recipe, std::size_t stage);
/// Sets it by name; false where the stage has no such answer.
bool set_answer(Recipe& recipe, std::size_t stage, std::string_view answer);

std::span<const std::string_view> distance_scaling_names();
std::span<const std::string_view> dynamic_lights_names();
std::span<const std::string_view> area_radius_names();
std::span<const std::string_view> wall_test_names();

struct Preset {
  std::string_view name;         // "lightcluster"
  std::string_view description;  // one line
  Recipe recipe;
};
std::span<const Preset> presets();

/// Why this recipe cannot be rendered, or nothing where it can.
std::optional<std::string> refusal(const Recipe& recipe);

}  // namespace chandelier
