// SPDX-License-Identifier: Apache-2.0
// What can change while a pack is shown: its lights, and where its instances stand. No Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <stdexcept>
#include <vector>

#include "pack_file.h"
#include "world/bounds.h"

namespace chandelier {

/// A light's number in the pack; lights that are added get the numbers after the pack's. An id is never given twice.
using LightId = uint32_t;
/// An instance's number in the pack.
using InstanceId = uint32_t;
/// Grows with every change of a world. 0: as the pack has it.
using Version = uint64_t;

/// One line: the id, what is wrong, and the offending value.
struct WorldError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// How much may be added to what the pack holds.
struct WorldRoom {
  uint32_t lights = 0;
};

/// A value that the caller owns and changes between frames. Renderer and Predictor read it by reference, so one world
/// serves several of them; none of them may be working while it changes. Geometry, materials and textures stay in the
/// pack.
class World {
 public:
  /// As the pack has it. What `pack` points to must outlive the world.
  explicit World(const pack::View& pack, const WorldRoom& room = {});
  explicit World(const pack::File& pack, const WorldRoom& room = {}) : World(pack.view(), room) {}
  World(pack::File&& pack, const WorldRoom& room = {}) = delete;
  World(const World&) = default;
  World(World&&) = default;
  // Who reads it remembers versions, which another world's are not.
  World& operator=(const World&) = delete;
  World& operator=(World&&) = delete;

  /// What does not change. Its lights, instances and batch instances are those of the bake: ask this world instead.
  const pack::View& pack() const { return pack_; }

  /// By id. The slot of a removed light holds one that shines nowhere; has_light() tells.
  std::span<const pack::Light> lights() const { return lights_; }
  bool has_light(LightId id) const { return id < lights_.size() && is_present_[id]; }
  /// Without the removed ones.
  uint32_t light_count() const { return light_count_; }

  /// Replaces a light, or brings a removed one back under its id. Units and limits are those of the pack's record
  /// Light; the direction has unit length. The world itself says where the light ends as a sphere (bounds), and which
  /// caster is nearest where the light has another place than before. Name and node stay. Position and range of a
  /// directional light are not looked at. Throws WorldError.
  void set_light(LightId id, const pack::Light& light);
  /// Throws WorldError, also where there is no room left.
  LightId add_light(const pack::Light& light);
  /// Its slot stays, so that no other light's id changes. Throws WorldError where there is no such light.
  void remove_light(LightId id);

  /// By id; `world_from_local` is where each stands now.
  std::span<const pack::Instance> instances() const { return instances_; }
  /// The pack's, each with a box around it where it stands now.
  std::span<const pack::BatchInstance> batch_instances() const { return batch_instances_; }
  /// The batch instances of an instance, as numbers.
  std::span<const uint32_t> batches_of(InstanceId id) const;
  /// Around everything. Not smaller than the bake's, wherever instances stand now.
  Bounds bounds() const;

  /// Moves an instance: the three rows of a 3×4 matrix, metres. Its batches' boxes become those of their moved boxes,
  /// which may be larger than tight ones. Triangles are wound for the bake's matrix, so the new one must mirror if and
  /// only if that one does. A light's near plane (pack Light, nearest_caster_m) does not follow: what moves to within
  /// 0.01 m of a light that stays may throw no shadow. Throws WorldError.
  void set_transform(InstanceId id, const std::array<glm::vec4, 3>& world_from_local);

  /// Of the last change of anything.
  Version version() const { return version_; }
  /// Of the last change of any light, added and removed ones included.
  Version lights_version() const { return lights_version_; }
  Version light_version(LightId id) const { return light_versions_.at(id); }
  /// Of the last change of any instance.
  Version instances_version() const { return instances_version_; }
  Version instance_version(InstanceId id) const { return instance_versions_.at(id); }
  /// Ids of what changed after a version, removed lights included, in no particular order. Takes no time where nothing
  /// did, and else as long as there are things that ever changed.
  std::vector<LightId> lights_changed_since(Version version) const;
  std::vector<InstanceId> instances_changed_since(Version version) const;

 private:
  void put_light(LightId id, const pack::Light& light, bool is_present);
  pack::Light checked(LightId id, const pack::Light& light) const;

  pack::View pack_;
  uint32_t most_lights_;
  std::vector<pack::Light> lights_;
  std::vector<bool> is_present_;
  uint32_t light_count_ = 0;
  std::vector<pack::Instance> instances_;
  std::vector<pack::BatchInstance> batch_instances_;
  std::vector<uint32_t> batches_by_instance_;  // numbers of batch instances
  std::vector<uint32_t> first_of_instance_;    // into it, of each instance; then its end
  Version version_ = 0;
  Version lights_version_ = 0;
  Version instances_version_ = 0;
  std::vector<Version> light_versions_;
  std::vector<Version> instance_versions_;
  std::vector<LightId> changed_lights_;  // ever, each once
  std::vector<InstanceId> moved_instances_;
};

}  // namespace chandelier
