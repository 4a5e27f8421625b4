// SPDX-License-Identifier: Apache-2.0
// Draws into a file, with no display.
#include "player/headless.h"

#include <fmt/format.h>

#include <cstdio>

#include "player/darkness.h"
#include "player/image_files.h"
#include "player/stats.h"

namespace chandelier::player {

void run_headless(const Options& options, const NamedCamera& camera, const pack::File& pack, const gpu::Device& device,
                  Renderer& renderer, const VisibilitySource& visibility) {
  const NamedRecipe& named = options.recipes.front();
  const RenderSettings settings = render_settings(options, named.recipe, camera.camera, visibility);
  renderer.warm_up(settings);
  std::vector<FrameStats> frames(options.frames.value_or(1));
  for (FrameStats& frame : frames) frame = renderer.draw(settings);

  Run run;
  run.pack = options.pack.filename().string();
  run.device = device.name;
  run.driver = device.driver;
  run.preset = named.preset;
  run.camera = camera;
  run.settings = settings;
  run.frames = static_cast<uint32_t>(frames.size());
  run.stats = medians(frames);
  run.shared_maps = named.shared_maps;
  run.expected_rmse = named.expected_rmse;
  run.image = options.output.filename().string();
  const Picture picture = renderer.read_back();
  write_picture(options.output, picture);
  if (!options.stats.empty()) write_file(options.stats, to_json(run).dump(2) + "\n");
  fmt::print(stderr, "{}: {}x{}, {}, {} lights, {} shadow maps, {:.1f} ms (median of {}) on {}\n",
             options.output.string(), settings.width, settings.height, named.preset, run.stats.lights,
             run.stats.shadow_maps, run.stats.frame_ms, run.frames, run.device);
  warn_of_black(options, pack.view(), picture);
}

}  // namespace chandelier::player
