// SPDX-License-Identifier: Apache-2.0
#include "lights/error_selection.h"

#include <algorithm>
#include <numeric>

#include "lights/map_search.h"
#include "lights/map_shares.h"
#include "lights/search_stopped.h"

namespace chandelier {
namespace {

constexpr size_t most_kept_members = 32;  // rungs whose members are remembered

}  // namespace

ErrorLadder::ErrorLadder(const LightSamples& samples, DynamicLights dynamic_lights,
                         std::span<const uint32_t> group_centers, const std::stop_token& stop)
    : samples_(samples), candidates_(samples.lights(), dynamic_lights) {
  std::vector<uint32_t> own(samples.lights().size());
  std::iota(own.begin(), own.end(), 0u);
  MapSearch search(samples, candidates_, group_centers, stop);
  add_rung(search.map_count(), search.error(), own, search.centers());
  for (std::vector<uint32_t> before = search.centers(); search.drop_one(); before = search.centers()) {
    search.settle();
    if (search.map_count() <= MapSearch::exchange_below) search.exchange();
    add_rung(search.map_count(), search.error(), before, search.centers());
    stop_if_asked(stop);
  }
  candidate_entries_ = search.candidate_entries();
  find_best();
}

void ErrorLadder::add_rung(uint32_t maps, double error, std::span<const uint32_t> before,
                           std::span<const uint32_t> now) {
  Rung& rung = rungs_.emplace_back(Rung{maps, error, {}, 0});
  for (uint32_t light = 0; light < now.size(); ++light)
    if (before[light] != now[light]) rung.changes.push_back({light, now[light]});
  rung.changes.shrink_to_fit();
  entries_ += rung.changes.size();
  while (entries_ > most_entries_per_light * now.size() && rungs_.size() > 2) thin_out();
}

// Every second rung becomes part of the one below it. The first and the last stay.
void ErrorLadder::thin_out() {
  std::vector<Rung> kept;
  std::map<uint32_t, uint32_t> changes;  // since the last one that was kept
  entries_ = 0;
  for (size_t i = 0; i < rungs_.size(); ++i) {
    for (const Change& change : rungs_[i].changes) changes[change.light] = change.center;
    if (i % 2 == 1 && i + 1 < rungs_.size()) continue;
    Rung& rung = kept.emplace_back(Rung{rungs_[i].maps, rungs_[i].error, {}, 0});
    for (const auto& [light, center] : changes) rung.changes.push_back({light, center});
    entries_ += rung.changes.size();
    changes.clear();
  }
  rungs_ = std::move(kept);
}

void ErrorLadder::find_best() {
  for (size_t i = rungs_.size(); i-- > 0;) {
    const bool is_last = i + 1 == rungs_.size();
    rungs_[i].best = is_last || rungs_[i].error <= rungs_[rungs_[i + 1].best].error ? i : rungs_[i + 1].best;
  }
}

std::vector<uint32_t> ErrorLadder::centers_at(size_t rung) const {
  std::vector<uint32_t> centers(samples_.lights().size());
  std::iota(centers.begin(), centers.end(), 0u);
  for (size_t i = 0; i <= rung; ++i)
    for (const Change& change : rungs_[i].changes) centers[change.light] = change.center;
  return centers;
}

const std::vector<MapMember>& ErrorLadder::members(size_t rung, const std::stop_token& stop) const {
  const size_t best = rungs_[rung].best;
  if (const auto known = members_.find(best); known != members_.end()) return known->second;
  if (members_.size() >= most_kept_members) members_.clear();
  const std::vector<uint32_t> center = centers_at(best);
  std::vector<uint32_t> centers;
  for (uint32_t light = 0; light < center.size(); ++light)
    if (center[light] == light) centers.push_back(light);
  std::vector<std::vector<uint32_t>> near(center.size());
  for (uint32_t light = 0; light < center.size(); ++light) {
    stop_if_asked(stop);
    if (center[light] != light) candidates_.nearest(light, centers, MapSearch::most_candidates, near[light]);
  }
  return members_.emplace(best, share_out(samples_, center, near, stop)).first->second;
}

std::vector<MapMember> ErrorLadder::with_at_most(uint32_t maps, const std::stop_token& stop) const {
  const auto found = std::find_if(rungs_.begin(), rungs_.end(), [&](const Rung& rung) { return rung.maps <= maps; });
  return members(found == rungs_.end() ? rungs_.size() - 1 : static_cast<size_t>(found - rungs_.begin()), stop);
}

std::vector<MapMember> ErrorLadder::within(double most_rmse, const LightSamples& judge, const ShadowReading& reading,
                                           const std::stop_token& stop) const {
  size_t fewest = 0, most = rungs_.size() - 1;  // numbers of rungs from the one with the fewest maps
  while (fewest < most) {
    const size_t middle = (fewest + most) / 2;
    if (estimated_rmse(judge, members(rungs_.size() - 1 - middle, stop), reading, stop) <= most_rmse)
      most = middle;
    else
      fewest = middle + 1;
  }
  return members(rungs_.size() - 1 - fewest, stop);
}

}  // namespace chandelier
