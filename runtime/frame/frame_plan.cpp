// SPDX-License-Identifier: Apache-2.0
#include "frame/frame_plan.h"

#include <algorithm>

#include "frame/clock.h"
#include "shadows/deliver/visibility_textures.h"
#include "shadows/project/shadow_views.h"
#include "shadows/store/cube_bytes.h"

namespace chandelier {
namespace {

std::array<glm::vec4, 4> columns(const glm::mat4& m) {
  return {m[0], m[1], m[2], m[3]};
}

frame::ViewConstants view_constants(const RenderSettings& settings, float aspect) {
  const glm::mat4 clip = clip_from_eye(settings.camera, aspect);
  return {.clip_from_eye = columns(clip),
          .eye_from_clip = columns(glm::inverse(clip)),
          .eye_ws = settings.camera.eye_ws,
          .near_m = settings.camera.znear_m,
          .forward_ws = axes_of(settings.camera).forward,
          .ambient = settings.ambient.coefficients,
          .size_px = {static_cast<float>(settings.width), static_cast<float>(settings.height)},
          .face_size_px = static_cast<float>(settings.recipe.face_size_px),
          .z_far_m = settings.recipe.z_far_m,
          .headlight = settings.headlight};
}

void refuse_unknown_answers(const Recipe& recipe) {
  const auto check = [](auto answer) {
    if (!is_valid(answer)) refuse_answer(answer);
  };
  for (size_t stage = 0; stage < stage_choices().size(); ++stage) with_answer(recipe, stage, check);
}

// LightCluster §5.4: where clusters are nearly as many as lights, a soft filter costs more than the maps saved. But the
// reference knows no shared maps: not those of groups, which are what their lights' author asked for, and not those of
// lights whose centres are held.
bool reference_is_cheaper(const Recipe& recipe, size_t lights, size_t maps, bool must_share) {
  return recipe.select == Select::light_clusters && maps > 0 && !must_share &&
         static_cast<float>(maps) >= recipe.reference_share * static_cast<float>(lights);
}

bool held_centers_share(const LightList& list, std::span<const LightId> held) {
  for (size_t i = 0; i < list.lights.size() && !held.empty(); ++i)
    if (list.center[i] != list.light_id[i] && held[list.light_id[i]] == list.center[i]) return true;
  return false;
}

// The reference's answers; everything else as asked. All stay soft where a light of the world has a radius.
Recipe reference_of(Recipe recipe, bool has_area_lights) {
  recipe.select = Select::per_light;
  if (!has_area_lights) recipe.filter = Filter::hard;
  recipe.deliver = Deliver::inlined;
  return recipe;
}

}  // namespace

FramePlan plan_frame(const World& world, const RenderSettings& settings, const GroupLimits& limits,
                     Surroundings* surroundings) {
  refuse_unknown_answers(settings.recipe);
  const float aspect = aspect_of(settings);
  const SelectionInputs inputs{.surroundings = surroundings,
                               .ambient = settings.ambient,
                               .headlight = settings.headlight,
                               .exposure_ev = settings.exposure_ev,
                               .previous_centers = settings.previous_centers,
                               .centers = settings.centers,
                               .out_of_view = settings.lights_out_of_view,
                               .search_beside_frames = settings.search_beside_frames};
  FramePlan plan{.recipe = settings.recipe};
  auto start = Clock::now();
  plan.list = select_lights(world, plan.recipe, settings.camera, aspect, inputs);
  if (reference_is_cheaper(plan.recipe, plan.list.shadowed_in_view(), plan.list.maps.size(),
                           group_shares(world, plan.list) || held_centers_share(plan.list, settings.centers))) {
    plan.recipe = reference_of(plan.recipe, plan.list.has_area_lights);
    plan.list = select_lights(world, plan.recipe, settings.camera, aspect, inputs);
  }
  plan.select_ms = ms_since(start);

  start = Clock::now();
  size_maps(plan.recipe, plan.list);
  if (plan.recipe.filter != Filter::rays)
    plan.views = project_lights(plan.list, settings.camera, aspect, world.bounds());
  if (has_textures(plan.recipe.deliver))
    place_visibility_rects(plan.list, settings.camera, settings.width, settings.height);
  plan.groups = plan_groups(plan.list, limits);
  plan.view = view_constants(settings, aspect);
  plan.views.push_back({.clip_from_center = plan.view.clip_from_eye, .center_ws = plan.view.eye_ws});
  plan.project_ms = ms_since(start);
  return plan;
}

ShadowMapCounter::ShadowMapCounter(const World& world, const RenderSettings& settings)
    : recipe_(settings.recipe),
      maps_(world, settings.recipe, settings.camera, aspect_of(settings), settings.lights_out_of_view) {}

uint64_t ShadowMapCounter::count(float d_init_m, uint64_t most) {
  const size_t maps = maps_.count(d_init_m, most);
  return reference_is_cheaper(recipe_, maps_.in_view(), maps, maps_.group_shares()) ? maps_.in_view() : maps;
}

FrameStats planned_stats(const World& world, const FramePlan& plan, const RenderSettings& settings) {
  const uint64_t cube = cube_bytes(settings.recipe.face_size_px);
  FrameStats stats;
  stats.lights = world.light_count();
  stats.lights_in_view = plan.list.lights_in_view;
  stats.shadowless_in_view = plan.list.shadowless.size();
  stats.light_clusters = plan.list.maps.size();
  stats.centers = centers_by_light(world, plan.list);
  stats.selection_is_provisional = plan.list.is_provisional;
  stats.reference_path = plan.recipe.select != settings.recipe.select;
  stats.shadow_maps = plan.recipe.filter == Filter::rays ? 0 : plan.list.maps.size();
  stats.shadow_views = plan.views.size() - 1;
  if (stats.shadow_maps > 0)
    for (const frame::ShadowMap& map : plan.list.maps) stats.shadow_bytes += cube_bytes(map.size_px);
  for (const MapGroup& group : plan.groups) {
    const uint64_t held = stats.shadow_maps == 0 ? 0 : group.cube_count * cube;
    stats.shadow_pool_bytes = std::max(stats.shadow_pool_bytes, held);
    stats.visibility_bytes += group.visibility_bytes;
    stats.visibility_pool_bytes = std::max(stats.visibility_pool_bytes, group.visibility_bytes);
    stats.shadow_rounds += group.map_count > 0;
  }
  return stats;
}

}  // namespace chandelier
