// SPDX-License-Identifier: Apache-2.0
#include "player/darkness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace chandelier::player {
namespace {

constexpr uint8_t darkest = 8;              // of 255: what is not brighter looks black
constexpr size_t pixels_for_one_lit = 500;  // with fewer lit ones the picture counts as black

void warn(const Options& options, const std::string& what) {
  fmt::print(stderr, "chandelier-play: warning: {}: {}\n", options.pack.string(), what);
}

// All materials are unlit.
bool is_unlit(const pack::View& pack) {
  return std::all_of(pack.materials.begin(), pack.materials.end(),
                     [](const pack::Material& material) { return material.unlit != 0; });
}

bool is_dark_without_lights(const Options& options, const pack::View& pack) {
  return pack.lights.empty() && options.headlight.value_or(0.0f) == 0.0f && options.ambient.is_dark() &&
         !is_unlit(pack);
}

}  // namespace

float automatic_headlight(const Options& options, const pack::View& pack) {
  return pack.lights.empty() && options.ambient.is_dark() ? headlight_on : 0.0f;
}

void warn_of_no_lights(const Options& asked, const Options& options, const pack::View& pack) {
  if (!pack.lights.empty() || is_unlit(pack)) return;
  const std::string lamps = fmt::format(
      "to have lamps, bake the scene together with a glTF that holds them: chandelier-bake SCENE.glb LAMPS.glb -o {}",
      options.pack.filename().string());
  if (is_dark_without_lights(options, pack))
    warn(options,
         "has no lights: only what glows is visible; --headlight on or --ambient 0.5 shows the rest; " + lamps);
  else if (!asked.headlight && options.ambient.is_dark())
    warn(options, "has no lights: a headlight in the camera shows it (--headlight off turns it off); " + lamps);
}

bool is_black(const Picture& picture) {
  const size_t pixels = picture.shown.size() / 4;
  size_t lit = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const uint8_t* const shown = &picture.shown[4 * i];
    lit += std::max({shown[0], shown[1], shown[2]}) > darkest;
  }
  return lit * pixels_for_one_lit < pixels;
}

void warn_of_black(const Options& options, const pack::View& pack, const Picture& picture) {
  if (is_dark_without_lights(options, pack) || !is_black(picture)) return;
  if (options.exposure_ev)
    warn(options,
         fmt::format("the picture is black with --exposure {:g}; try --exposure auto, which works unless nothing in "
                     "view is lit",
                     *options.exposure_ev));
  else if (options.headlight.value_or(0.0f) > 0.0f || !options.ambient.is_dark())
    warn(options, "the picture is black: the camera sees nothing, or only black surfaces; try another --camera");
  else
    warn(options,
         "the picture is black: the camera sees nothing that a light reaches; try --headlight on, --ambient 0.5 or "
         "another --camera");
}

}  // namespace chandelier::player
