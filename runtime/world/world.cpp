// SPDX-License-Identifier: Apache-2.0
#include "world/world.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pack_checks.h"
#include "world/nearest_caster.h"

namespace chandelier {
namespace {

std::string light_text(LightId id) {
  return "light " + std::to_string(id);
}

// Shines nowhere, throws no shadow and has no size, so that sums over all slots are right.
pack::Light absent_light(const pack::Light& before) {
  pack::Light light;
  light.direction_ws = {0.0f, -1.0f, 0.0f};
  light.inner_cone_cos = 1.0f;
  light.outer_cone_cos = -1.0f;
  light.shadowless = 1;
  light.node = before.node;
  light.name = before.name;
  return light;
}

double determinant(const std::array<glm::vec4, 3>& rows) {
  return glm::determinant(glm::dmat3(glm::dvec3(rows[0]), glm::dvec3(rows[1]), glm::dvec3(rows[2])));
}

float rounded_down(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} > value ? std::nextafter(nearest, -INFINITY) : nearest;
}

// Around a box that is moved: centre and half size, axis by axis (Arvo 1990, Transforming axis-aligned bounding boxes).
Bounds moved(const std::array<glm::vec4, 3>& rows, const glm::vec3& min_ls, const glm::vec3& max_ls) {
  const glm::dvec3 center = 0.5 * (glm::dvec3(min_ls) + glm::dvec3(max_ls));
  const glm::dvec3 half = 0.5 * (glm::dvec3(max_ls) - glm::dvec3(min_ls));
  Bounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 row(rows[axis]);
    const double middle = glm::dot(row, center) + double{rows[axis].w};
    const double extent = glm::dot(glm::abs(row), half);
    bounds.min_ws[axis] = rounded_down(middle - extent);
    bounds.max_ws[axis] = -rounded_down(-(middle + extent));
  }
  return bounds;
}

template <typename Id>
std::vector<Id> changed_since(Version version, Version last, const std::vector<Id>& changed,
                              const std::vector<Version>& versions) {
  std::vector<Id> ids;
  if (last <= version) return ids;
  std::copy_if(changed.begin(), changed.end(), std::back_inserter(ids), [&](Id id) { return versions[id] > version; });
  return ids;
}

}  // namespace

World::World(const pack::View& pack, const WorldRoom& room)
    : pack_(pack),
      most_lights_(static_cast<uint32_t>(pack.lights.size()) + room.lights),
      is_present_(pack.lights.size(), true),
      light_count_(static_cast<uint32_t>(pack.lights.size())),
      instances_(pack.instances.begin(), pack.instances.end()),
      batch_instances_(pack.batch_instances.begin(), pack.batch_instances.end()),
      batches_by_instance_(pack.batch_instances.size()),
      first_of_instance_(pack.instances.size() + 1),
      light_versions_(pack.lights.size()),
      instance_versions_(pack.instances.size()) {
  lights_.reserve(most_lights_);
  lights_.assign(pack.lights.begin(), pack.lights.end());
  for (const pack::BatchInstance& draw : batch_instances_) ++first_of_instance_[draw.instance + 1];
  for (size_t i = 1; i < first_of_instance_.size(); ++i) first_of_instance_[i] += first_of_instance_[i - 1];
  std::vector<uint32_t> next = first_of_instance_;
  for (uint32_t i = 0; i < batch_instances_.size(); ++i) batches_by_instance_[next[batch_instances_[i].instance]++] = i;
}

pack::Light World::checked(LightId id, const pack::Light& light) const {
  const pack::Light& before = lights_[id];
  pack::Light out = light;
  out.node = before.node;
  out.name = before.name;
  out.voxel = pack::none;
  const bool is_directional = out.type == pack::LightType::directional;
  if (is_directional) {
    out.position_ws = glm::vec3(0.0f);
    out.range_m = 0.0f;
  }
  out.bounds_center_ws = out.position_ws;
  out.bounds_radius_m = out.range_m;
  const bool stays = is_present_[id] && before.type == out.type && before.position_ws == out.position_ws;
  out.nearest_caster_m = stays ? before.nearest_caster_m : 0.0f;
  if (const std::string fault = pack::light_fault(out); !fault.empty()) throw WorldError(light_text(id) + fault);
  if (!stays && !is_directional) out.nearest_caster_m = nearest_caster_m(*this, out.position_ws, out.range_m);
  return out;
}

void World::put_light(LightId id, const pack::Light& light, bool is_present) {
  light_count_ += is_present;
  light_count_ -= is_present_[id];
  lights_[id] = light;
  is_present_[id] = is_present;
  if (light_versions_[id] == 0) changed_lights_.push_back(id);
  light_versions_[id] = lights_version_ = ++version_;
}

void World::set_light(LightId id, const pack::Light& light) {
  if (id >= lights_.size())
    throw WorldError(light_text(id) + ": there is none; ids are below " + std::to_string(lights_.size()));
  put_light(id, checked(id, light), true);
}

LightId World::add_light(const pack::Light& light) {
  const auto id = static_cast<LightId>(lights_.size());
  if (id == most_lights_)
    throw WorldError(light_text(id) + ": there is no room; the world was made for " + std::to_string(most_lights_) +
                     " lights");
  lights_.push_back(absent_light({}));
  is_present_.push_back(false);
  light_versions_.push_back(0);
  try {
    put_light(id, checked(id, light), true);
  } catch (...) {  // as if nothing had been asked for
    lights_.pop_back();
    is_present_.pop_back();
    light_versions_.pop_back();
    throw;
  }
  return id;
}

void World::remove_light(LightId id) {
  if (!has_light(id)) throw WorldError(light_text(id) + ": there is none to remove");
  put_light(id, absent_light(lights_[id]), false);
}

std::span<const uint32_t> World::batches_of(InstanceId id) const {
  return std::span(batches_by_instance_)
      .subspan(first_of_instance_[id], first_of_instance_[id + 1] - first_of_instance_[id]);
}

Bounds World::bounds() const {
  if (!pack_.bake_info) return {};
  Bounds bounds{pack_.bake_info->bounds_min_ws, pack_.bake_info->bounds_max_ws};
  for (const InstanceId id : moved_instances_)
    for (const uint32_t number : batches_of(id))
      bounds = enclosing(bounds, {batch_instances_[number].bounds_min_ws, batch_instances_[number].bounds_max_ws});
  return bounds;
}

void World::set_transform(InstanceId id, const std::array<glm::vec4, 3>& world_from_local) {
  const std::string name = "instance " + std::to_string(id);
  if (id >= instances_.size())
    throw WorldError(name + ": there is none; ids are below " + std::to_string(instances_.size()));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      if (!std::isfinite(world_from_local[row][column]))
        throw WorldError(name + ".world_from_local: row " + std::to_string(row) + " has a number that is not finite (" +
                         std::to_string(world_from_local[row][column]) + ")");
  if (const double now = determinant(world_from_local); now * determinant(pack_.instances[id].world_from_local) < 0.0)
    throw WorldError(name + ".world_from_local: mirrors, unlike the bake's, for which its triangles are wound " +
                     "(determinant " + std::to_string(now) + ")");
  instances_[id].world_from_local = world_from_local;
  for (const uint32_t number : batches_of(id)) {
    pack::BatchInstance& draw = batch_instances_[number];
    const pack::Batch& batch = pack_.batches[draw.batch];
    const Bounds bounds = moved(world_from_local, batch.bounds_min_ls, batch.bounds_max_ls);
    draw.bounds_min_ws = bounds.min_ws;
    draw.bounds_max_ws = bounds.max_ws;
  }
  if (instance_versions_[id] == 0) moved_instances_.push_back(id);
  instance_versions_[id] = instances_version_ = ++version_;
}

std::vector<LightId> World::lights_changed_since(Version version) const {
  return changed_since(version, lights_version_, changed_lights_, light_versions_);
}

std::vector<InstanceId> World::instances_changed_since(Version version) const {
  return changed_since(version, instances_version_, moved_instances_, instance_versions_);
}

}  // namespace chandelier
