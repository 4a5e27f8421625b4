// SPDX-License-Identifier: Apache-2.0
#include "lights/error_driven.h"

#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>

#include "lights/pack_lights.h"
#include "lights/search_stopped.h"

namespace chandelier {
namespace {

// Of two recipes that select by error. Light clusters and groups follow from recipe, view and world (stability has no
// say: select_members() gives them no previous centres).
bool ask_the_same(const ErrorTask& a, const ErrorTask& b) {
  const auto asked = [](const Recipe& r) {
    return std::tie(r.max_maps, r.max_rmse, r.filter, r.face_size_px, r.d_init_m, r.z_far_m, r.distance_scaling,
                    r.dynamic_lights, r.area_radius, r.walls);
  };
  return asked(a.recipe) == asked(b.recipe) && a.view == b.view && a.key == b.key;
}

// Index of an id among ascending ones, or their number.
uint32_t index_of(std::span<const LightId> ids, LightId id) {
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  return static_cast<uint32_t>((found != ids.end() && *found == id ? found : ids.end()) - ids.begin());
}

// What another task's members say of the lights of this one.
class Adapted {
 public:
  Adapted(const World& world, const ErrorTask& task) : world_(world), task_(task), members_(task.key.in_view.size()) {}

  void add(const ErrorTask& of, const MapMember& member) {
    const uint32_t light = index_of(task_.key.in_view, of.key.in_view[member.light]);
    const uint32_t center = index_of(task_.key.in_view, of.key.in_view[member.center]);
    if (light == members_.size() || center == members_.size() || !may_share(light, center)) return;
    members_[light].push_back({light, center, member.filter_radius_m, member.share});
  }

  // Each light's shares add up to 1.
  std::vector<MapMember> take() {
    std::vector<MapMember> all;
    for (uint32_t light = 0; light < members_.size(); ++light) {
      auto& of_light = members_[light];
      const bool is_grouped = lamp(light).group != 0;
      if (is_grouped) of_light = {{light, task_.group_centers[light], 0.0f}};
      if (of_light.empty()) of_light = {{light, light, 0.0f}};
      float sum = 0.0f;
      for (const MapMember& member : of_light) sum += member.share;
      for (MapMember& member : of_light) {
        member.share = of_light.size() == 1 ? 1.0f : member.share / sum;
        all.push_back(member);
      }
    }
    return all;
  }

 private:
  const pack::Light& lamp(uint32_t light) const { return world_.lights()[task_.key.in_view[light]]; }
  bool keeps_own(uint32_t light) const {
    return lamp(light).group != 0 || lamp(light).unclustered != 0 ||
           (lamp(light).dynamic != 0 && task_.recipe.dynamic_lights == DynamicLights::own);
  }
  bool may_share(uint32_t light, uint32_t center) const {
    return light == center ||
           (is_directional(lamp(light)) == is_directional(lamp(center)) && !keeps_own(light) && !keeps_own(center));
  }

  const World& world_;
  const ErrorTask& task_;
  std::vector<std::vector<MapMember>> members_;  // of each light in view
};

}  // namespace

ErrorDriven::ErrorDriven(const World& world, const rays::PackRays& rays, MeanMaterialsOf materials_of)
    : world_(world),
      rays_(rays),
      searched_(rays),
      instances_(world.instances_version()),
      scene_(world.pack(), searched_, materials_of),
      search_(scene_) {}

std::vector<MapMember> ErrorDriven::select(const ErrorTask& task) {
  stop();
  follow_instances();
  return search_.select(task, sampled_lights(world_, task.key.in_view), {});
}

bool ErrorDriven::has_news() const {
  return running_.valid() && running_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

bool ErrorDriven::knows(const ErrorTask& task) const {
  return last_ && ask_the_same(task, *last_->task);
}

// Only while no search runs. What search_ has kept of other instances it makes anew: its key tells.
void ErrorDriven::follow_instances() {
  if (instances_ == world_.instances_version()) return;
  searched_ = rays_;
  instances_ = world_.instances_version();
}

void ErrorDriven::begin(const ErrorTask& task) {
  follow_instances();
  stop_ = std::stop_source();
  // Copies: the world may change while the search goes on.
  running_ = std::async(
      std::launch::async,
      [this, asked = std::make_shared<const ErrorTask>(task), lights = sampled_lights(world_, task.key.in_view),
       stop = stop_.get_token()]() -> std::optional<Found> {
        try {
          return Found{asked, search_.select(*asked, lights, stop)};
        } catch (const SearchStopped&) {
          return std::nullopt;
        }
      });
}

// Throws what the search threw.
std::optional<ErrorAnswer> ErrorDriven::select_beside(const ErrorTask& task) {
  if (knows(task)) stop_.request_stop();
  if (has_news()) {
    auto found = running_.get();
    if (found && !knows(task)) last_ = std::move(found);
  }
  if (knows(task)) return ErrorAnswer{last_->members, true};
  if (!running_.valid()) begin(task);
  if (!last_) return std::nullopt;
  Adapted adapted(world_, task);
  for (const MapMember& member : last_->members) adapted.add(*last_->task, member);
  return ErrorAnswer{adapted.take(), false};
}

// What the search found is left for select_beside() to judge.
void ErrorDriven::stop() {
  stop_.request_stop();
  if (running_.valid()) running_.wait();
}

double ErrorDriven::expected_rmse(std::span<const LightId> in_view, std::span<const MapMember> members,
                                  const SampledView& view, const Recipe& recipe) {
  stop();
  follow_instances();
  return search_.expected_rmse(world_key(world_, in_view), sampled_lights(world_, in_view), view, members, recipe);
}

}  // namespace chandelier
