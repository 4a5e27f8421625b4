// SPDX-License-Identifier: Apache-2.0
#include "shadows/store/kept_maps.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace chandelier {
namespace {

MapContents contents_of(const frame::ShadowMap& map, const World& world, Cull cull, const LightList& list,
                        std::span<const frame::ShadowView> views) {
  MapContents contents;
  contents.center = list.center[map.first_light];
  contents.light_version = world.light_version(contents.center);
  contents.instances_version = world.instances_version();
  contents.cull = cull;
  std::ranges::copy(views.subspan(map.first_view, map.view_count), contents.views.begin());
  for (frame::ShadowView& view : contents.views) {
    view.layer %= 6;
    view.left_px = view.top_px = 0;
  }
  return contents;
}

// Records hold four-byte numbers without gaps.
bool same(const MapContents& a, const MapContents& b) {
  return a.light_version == b.light_version && a.instances_version == b.instances_version && a.cull == b.cull &&
         std::memcmp(a.views.data(), b.views.data(), sizeof a.views) == 0;
}

}  // namespace

KeptMaps::KeptMaps(uint32_t layer_size_px, uint32_t cubes)
    : layer_size_px_(layer_size_px), cubes_(cubes), free_(layer_size_px, cubes) {}

void KeptMaps::forget() {
  entries_.clear();
  free_ = CubePlaces(layer_size_px_, cubes_);
}

std::optional<CubePlace> KeptMaps::find(const MapContents& contents) {
  const auto [first, end] = entries_.equal_range(contents.center);
  for (auto entry = first; entry != end; ++entry) {
    if (entry->second.last_use == now_ || !same(entry->second.contents, contents)) continue;
    entry->second.last_use = now_;
    return entry->second.place;
  }
  return std::nullopt;
}

// Frees what was used longest ago until there is room.
std::optional<CubePlace> KeptMaps::take(uint32_t size_px) {
  std::optional<CubePlace> place = free_.take(size_px);
  while (!place) {
    const auto oldest = std::ranges::min_element(
        entries_, [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
    if (oldest == entries_.end() || oldest->second.last_use == now_) return std::nullopt;
    free_.give_back(oldest->second.place);
    entries_.erase(oldest);
    place = free_.take(size_px);
  }
  return place;
}

bool KeptMaps::take_others(std::span<const frame::ShadowMap> maps) {
  for (size_t i = 0; i < maps.size(); ++i) {
    if (places_[i]) continue;
    places_[i] = take(maps[i].size_px);
    if (!places_[i]) return false;
    entries_.emplace(contents_[i].center, Entry{contents_[i], *places_[i], now_});
  }
  return true;
}

void KeptMaps::place(const MapGroup& group, const World& world, Cull cull, LightList& list,
                     std::vector<frame::ShadowView>& views) {
  ++now_;
  const auto maps = std::span(list.maps).subspan(group.first_map, group.map_count);
  contents_.clear();
  places_.clear();
  for (const frame::ShadowMap& map : maps) {
    contents_.push_back(contents_of(map, world, cull, list, views));
    places_.push_back(find(contents_.back()));
  }
  for (size_t i = 0; i < maps.size(); ++i) maps[i].is_kept = places_[i].has_value();
  if (!take_others(maps)) {  // what is kept leaves no square that is large enough
    forget();
    places_.assign(maps.size(), std::nullopt);
    if (!take_others(maps)) throw std::logic_error("a group of maps that does not fit");
    for (frame::ShadowMap& map : maps) map.is_kept = 0;
  }
  for (size_t i = 0; i < maps.size(); ++i) {
    const CubePlace& place = *places_[i];
    maps[i].cube = place.cube;
    maps[i].left_px = place.left_px;
    maps[i].top_px = place.top_px;
    for (frame::ShadowView& view : std::span(views).subspan(maps[i].first_view, maps[i].view_count)) {
      view.layer = view.layer % 6 + 6 * place.cube;
      view.left_px = place.left_px;
      view.top_px = place.top_px;
    }
  }
}

}  // namespace chandelier
