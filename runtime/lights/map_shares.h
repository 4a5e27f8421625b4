// SPDX-License-Identifier: Apache-2.0
// A light in several shadow maps at once: where none of them shows what the light would see, two that are wrong in
// different places are less wrong together.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "lights/error_estimate.h"
#include "lights/light_samples.h"

namespace chandelier {

/// From the one map of each light, `center`, to shares in several: a light without a map of its own takes up to three
/// of the maps of those `candidates` (of each light, nearest first) that are centres, so that hard shadows err less at
/// the samples' points: in luminance, never more than with `center` alone. In the order of centres, then of lights.
/// Throws SearchStopped.
std::vector<MapMember> share_out(const LightSamples& samples, std::span<const uint32_t> center,
                                 std::span<const std::vector<uint32_t>> candidates, const std::stop_token& stop = {});

}  // namespace chandelier
