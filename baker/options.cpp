// SPDX-License-Identifier: Apache-2.0
// The command line, read by CLI11.
#include "options.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "bake/voxel_grid.h"
#include "error.h"

namespace chandelier::baker {
namespace {

constexpr const char* baking_group = "Baking";

constexpr const char* examples = R"(Examples:
  chandelier-bake scene.glb -o scene.chandelier
  chandelier-bake hall.gltf lamps.gltf -o hall.chandelier     a scene and its lights from two files
  chandelier-bake house.gltf -o upper.chandelier --scene "upper floor"     one scene of several in the file
  chandelier-bake city.gltf -o city.chandelier --batch-triangles 128 --range-threshold 0.2
  chandelier-bake hall.gltf -o hall.chandelier --cache ~/.cache/chandelier --depfile hall.d     in a build
  chandelier-bake hall.gltf -o hall.chandelier --json -                                         for a program

Exit code: 0 baked, 1 failed (one line on stderr says why; an older pack stays as it was), 2 wrong usage.)";

std::string check_batch_triangles(const std::string& text) {
  uint32_t value = 0;
  if (!CLI::detail::lexical_cast(text, value) || value < 4 || value > 512 || value % 4 != 0) {
    return "must be a multiple of 4 from 4 to 512 (" + text + ")";
  }
  return {};
}

std::string check_range_threshold(const std::string& text) {
  float value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || !(value > 0)) {
    return "must be a positive number (" + text + ")";
  }
  return {};
}

std::string check_position_error(const std::string& text) {
  float value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !(value >= 0 && value <= 1)) {
    return "must be a number from 0 to 1 (" + text + ")";
  }
  return {};
}

std::string check_smooth_angle(const std::string& text) {
  float value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !(value >= 0 && value <= 180)) {
    return "must be a number from 0 to 180 (" + text + ")";
  }
  return {};
}

/// N, or NX,NY,NZ: cells along each axis, at least one along every axis, or 0 for no grid.
std::optional<std::array<uint32_t, 3>> resolution_of(const std::string& text) {
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  std::array<uint32_t, 3> out{};
  if (parts.size() != 1 && parts.size() != 3) return std::nullopt;
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::string& part = parts[parts.size() == 1 ? 0 : axis];
    if (!CLI::detail::lexical_cast(part, out[axis]) || out[axis] > most_voxels_on_axis) return std::nullopt;
  }
  if (out[0] == 0 && out[1] == 0 && out[2] == 0) return out;
  const uint64_t cells = uint64_t{out[0]} * out[1] * out[2];
  return cells > 0 && cells <= most_voxels ? std::optional(out) : std::nullopt;
}

std::string check_voxels(const std::string& text) {
  if (resolution_of(text)) return {};
  return "must be N or NX,NY,NZ, each from 1 to " + std::to_string(most_voxels_on_axis) + " and at most " +
         std::to_string(most_voxels) + " cells in all, or 0 (" + text + ")";
}

std::string check_voxel_large(const std::string& text) {
  return text == "separate" || text == "clip" ? "" : "must be separate or clip (" + text + ")";
}

void add_voxel_options(CLI::App& app, VoxelSettings& voxels) {
  app.add_option_function<std::string>(
         "--voxels", [&voxels](const std::string& text) { voxels.resolution = *resolution_of(text); },
         "Cells of the voxel grid along each axis, N or NX,NY,NZ; 0 makes no grid")
      ->default_str("32")
      ->check(CLI::Validator(check_voxels, ""));
  app.add_option_function<std::string>(
         "--voxel-large",
         [&voxels](const std::string& text) {
           voxels.mode = text == "clip" ? pack::VoxelMode::clip : pack::VoxelMode::separate;
         },
         "Triangles in more than two cells: separate always draws them, clip cuts all triangles at cell faces")
      ->default_str("separate")
      ->check(CLI::Validator(check_voxel_large, ""));
}

/// An empty path is most likely an unset variable of a script: refuse it.
std::string check_path(const std::string& text) {
  return text.empty() ? "must be a path ('')" : "";
}

std::string check_scene(const std::string& text) {
  return text.empty() ? "must be a scene's name or number ('')" : "";
}

template <int Least, int Most>
std::string check_whole_number(const std::string& text) {
  int value = 0;
  if (!CLI::detail::lexical_cast(text, value) || value < Least || value > Most) {
    return "must be a whole number from " + std::to_string(Least) + " to " + std::to_string(Most) + " (" + text + ")";
  }
  return {};
}

std::string check_textures(const std::string& text) {
  return text == "bc" || text == "raw" || text == "none" ? "" : "must be bc, raw or none (" + text + ")";
}

void add_image_options(CLI::App& app, ImageSettings& images) {
  app.add_option_function<std::string>(
         "--textures",
         [&images](const std::string& text) {
           images.textures = text == "bc" ? TextureMode::bc : text == "raw" ? TextureMode::raw : TextureMode::none;
         },
         "How images are stored: bc: compressed blocks (BC1, BC3, BC5), raw: 4 bytes per texel, none: no images")
      ->default_str("bc")
      ->check(CLI::Validator(check_textures, ""));
  app.add_option("--max-texture-size", images.max_size,
                 "Halve images until no side is longer than this, texels; 0 sets no limit")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<0, 16384>, ""));
  app.add_flag("--strict", images.strict,
               "Refuse damaged images; without it they are baked as far as they can be decoded, with a warning");
}

/// Options for build systems.
void add_build_options(CLI::App& app, Options& options) {
  app.option_defaults()->group("Build step");
  app.add_option("--cache", options.cache,
                 "Folder that keeps results for later bakes of the same files; made if it is missing")
      ->type_name("DIR")
      ->check(CLI::Validator(check_path, ""));
  app.add_option("--depfile", options.depfile, "Write the list of files that were read, for Ninja and Make")
      ->type_name("FILE")
      ->check(CLI::Validator(check_path, ""));
  app.add_option("--json", options.json, "Write a report: times, counts and bytes of each pass, warnings; - is stdout")
      ->type_name("FILE")
      ->check(CLI::Validator(check_path, ""));
  app.add_option("-j,--threads", options.threads,
                 "Number of threads; 0: all cores. The pack is the same for any number")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<0, 1024>, ""));
  auto* quiet = app.add_flag("-q,--quiet", options.quiet, "Print no progress and no summary, only warnings and errors");
  app.add_flag("-v,--verbose", options.verbose, "Print how long each pass took")->excludes(quiet);
}

/// The options that affect the pack, with their values, given or default.
std::vector<std::pair<std::string, std::string>> settings_of(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group() != baking_group) continue;
    const bool flag = option->get_expected_max() == 0;
    std::string value = flag ? "false" : option->get_default_str();
    if (option->count() > 0) value = flag ? "true" : option->results().back();
    out.emplace_back(option->get_single_name(), value);
  }
  return out;
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  CLI::App app("Bakes glTF scenes into a pack for chandelier-play. Several inputs are merged into one scene.",
               "chandelier-bake");
  app.footer(examples);
  app.set_version_flag("--version", "chandelier-bake " CHANDELIER_VERSION);
  app.add_option("SCENE", options.inputs, "glTF 2.0 files, .gltf or .glb")->required();
  app.add_option("-o,--output", options.output, "The pack to write, PACK.chandelier")->required();
  app.option_defaults()->group(baking_group);
  app.add_option("--scene", options.import.scene,
                 "The scene to bake where a glTF has several: its name, or its number from 0 [the one that the file "
                 "shows first]")
      ->type_name("NAME|N")
      ->check(CLI::Validator(check_scene, ""));
  app.add_option("--batch-triangles", options.bake.batch_triangles,
                 "Largest number of triangles in a batch, a multiple of 4 from 4 to 512")
      ->capture_default_str()
      ->check(CLI::Validator(check_batch_triangles, ""));
  app.add_option("--range-threshold", options.bake.range_threshold_lx,
                 "A light without a range ends where its illuminance has fallen to this, lux")
      ->capture_default_str()
      ->check(CLI::Validator(check_range_threshold, ""));
  app.add_option("--position-error", options.bake.position_error_m,
                 "Largest distance that a vertex may move so that it takes fewer bits, metres, 0 to 1; 0 keeps floats")
      ->capture_default_str()
      ->check(CLI::Validator(check_position_error, ""));
  app.add_option("--normal-bits", options.bake.normal_bits, "Bits of each of a normal's two stored numbers, 8 to 16")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<8, 16>, ""));
  app.add_option("--uv-bits", options.bake.uv_bits, "Fractional bits of a texture coordinate, up to 20; 0 keeps floats")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<0, 20>, ""));
  app.add_option("--smooth-angle", options.bake.smooth_angle_deg,
                 "Where normals are missing, smooth across edges up to this angle, degrees; 0 makes all faces flat, as "
                 "glTF asks")
      ->capture_default_str()
      ->check(CLI::Validator(check_smooth_angle, ""));
  app.add_flag("--glass-shadows", options.bake.glass_shadows,
               "Materials that let half of the light or more through (KHR_materials_transmission) cast shadows too, as "
               "if they were opaque");
  add_voxel_options(app, options.bake.voxels);
  add_image_options(app, options.bake.images);
  app.add_flag("--compress", options.compress,
               "Make the pack small: compress sections and single images where that saves; sections are decoded when "
               "the pack is opened, images when they are used");
  add_build_options(app, options);
  try {
    app.parse(argc, argv);
    options.settings = settings_of(app);
    if (options.json == "/dev/stdout") options.json = "-";
    return options;
  } catch (const CLI::Success& answer) {  // --help, --version
    exit_code = app.exit(answer);
  } catch (const CLI::ParseError& error) {
    std::cerr << "chandelier-bake: error: " << printable(error.what()) << " (--help explains)\n";
    exit_code = 2;
  }
  return std::nullopt;
}

}  // namespace chandelier::baker
