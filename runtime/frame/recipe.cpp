// SPDX-License-Identifier: Apache-2.0
#include "frame/recipe.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chandelier {
namespace {

using Names = std::span<const std::string_view>;

// In the order of the enumerators in recipe.h.
constexpr std::string_view g_buffer_names[]{"depth-normal-material"};
constexpr std::string_view select_names[]{"per-light", "light-clusters", "error-driven"};
constexpr std::string_view lookup_names[]{"all", "tiles"};
constexpr std::string_view store_names[]{"cube-array"};
constexpr std::string_view project_names[]{"cube"};
constexpr std::string_view cull_names[]{"none", "light-frustum"};
constexpr std::string_view rasterize_names[]{"multi-draw"};
constexpr std::string_view filter_names[]{"hard", "pcf", "pcss", "rays"};
constexpr std::string_view deliver_names[]{"inline", "textures"};
constexpr std::string_view shade_names[]{"ggx", "lambert"};
constexpr std::string_view scaling_names[]{"grow", "paper-formula", "none"};
constexpr std::string_view dynamic_names[]{"cluster", "own"};
constexpr std::string_view radius_names[]{"d-min", "spread"};
constexpr std::string_view wall_names[]{"none", "voxels", "rays"};

constexpr StageChoices stages[]{
    {"g-buffer", "what does the camera see?", g_buffer_names},
    {"select", "which lights get a shadow map?", select_names},
    {"lookup", "which lights reach a pixel?", lookup_names},
    {"store", "where do a light's depths live?", store_names},
    {"project", "onto what are they projected?", project_names},
    {"cull", "which triangles go into which shadow view?", cull_names},
    {"rasterize", "how are they drawn?", rasterize_names},
    {"filter", "how is visibility read?", filter_names},
    {"deliver", "how does it reach shading?", deliver_names},
    {"shade", "how does a surface reflect?", shade_names},
};

template <typename Enum>
bool set_by_name(Enum& value, Names names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return false;
  value = static_cast<Enum>(found - names.begin());
  return true;
}

// Calls `use` with the recipe's answer to a stage, whose type differs from stage to stage.
template <typename RecipeType, typename Use>
auto with_answer(RecipeType& recipe, std::string_view stage, Use use) {
  if (stage == "select") return use(recipe.select);
  if (stage == "lookup") return use(recipe.lookup);
  if (stage == "store") return use(recipe.store);
  if (stage == "project") return use(recipe.project);
  if (stage == "cull") return use(recipe.cull);
  if (stage == "rasterize") return use(recipe.rasterize);
  if (stage == "filter") return use(recipe.filter);
  if (stage == "deliver") return use(recipe.deliver);
  if (stage == "shade") return use(recipe.shade);
  return use(recipe.g_buffer);
}

constexpr Recipe lightcluster_recipe(Filter filter) {
  Recipe recipe;
  recipe.select = Select::light_clusters;
  recipe.filter = filter;
  return recipe;
}

constexpr Recipe chandelier_recipe() {
  Recipe recipe;
  recipe.select = Select::error_driven;
  return recipe;
}

constexpr Recipe truth_recipe() {
  Recipe recipe;
  recipe.filter = Filter::rays;
  recipe.deliver = Deliver::textures;
  return recipe;
}

const std::array preset_list{
    Preset{"reference", "one shadow map per light in view, hard shadows: what the others are measured against",
           Recipe{}},
    Preset{"lightcluster", "one shadow map per light cluster, read by PCSS (LightCluster)",
           lightcluster_recipe(Filter::pcss)},
    Preset{"lightcluster-pcf", "the same, read by PCF", lightcluster_recipe(Filter::pcf)},
    Preset{"chandelier",
           "hard shadows; no more shadow maps than light clusters, and as few as are expected to err clearly less",
           chandelier_recipe()},
    Preset{"truth", "rays from every visible point to every light, on the CPU: what shadow maps are measured against",
           truth_recipe()},
};

}  // namespace

std::span<const StageChoices> stage_choices() {
  return stages;
}

std::string_view answer(const Recipe& recipe, std::size_t stage) {
  return with_answer(recipe, stages[stage].stage,
                     [&](auto value) { return stages[stage].answers[static_cast<std::size_t>(value)]; });
}

bool set_answer(Recipe& recipe, std::size_t stage, std::string_view name) {
  return with_answer(recipe, stages[stage].stage,
                     [&](auto& value) { return set_by_name(value, stages[stage].answers, name); });
}

std::span<const std::string_view> distance_scaling_names() {
  return scaling_names;
}

std::span<const std::string_view> dynamic_lights_names() {
  return dynamic_names;
}

std::span<const std::string_view> area_radius_names() {
  return radius_names;
}

std::span<const std::string_view> wall_test_names() {
  return wall_names;
}

std::span<const Preset> presets() {
  return preset_list;
}

std::optional<std::string> refusal(const Recipe& recipe) {
  const bool clustered = recipe.select == Select::light_clusters;
  if (!std::isfinite(recipe.d_init_m) || recipe.d_init_m < 0.0f) return "d-init must be a distance of 0 m or more";
  if (!std::isfinite(recipe.z_far_m) || recipe.z_far_m <= 0.0f) return "z-far must be a distance above 0 m";
  if (!(recipe.reference_share > 0.0f)) return "reference-share must be above 0";
  if (!(recipe.stability >= 0.0f && recipe.stability < 1.0f)) return "stability must be from 0 to below 1";
  if (recipe.max_rmse && !(*recipe.max_rmse >= 0.0f)) return "max-error must be 0 or more";
  if (recipe.face_size_px < 16 || recipe.face_size_px > 16384) return "face-size must be from 16 to 16384 texels";
  if (clustered && recipe.filter == Filter::hard && recipe.d_init_m > 0.0f)
    return "select light-clusters with filter hard: lights that share a map need a soft filter (LightCluster §3.2.1); "
           "use filter pcss or pcf, or d-init 0";
  if (recipe.filter == Filter::rays && (recipe.select != Select::per_light || recipe.deliver != Deliver::textures))
    return "filter rays: needs select per-light and deliver textures (preset truth)";
  return std::nullopt;
}

}  // namespace chandelier
