// SPDX-License-Identifier: Apache-2.0
// The command line, read by CLI11.
#include "options.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "error.h"

namespace chandelier::baker {
namespace {

constexpr const char* kExamples = R"(Examples:
  chandelier-bake scene.glb -o scene.chandelier
  chandelier-bake hall.gltf lamps.gltf -o hall.chandelier     a scene and its lights from two files
  chandelier-bake city.gltf -o city.chandelier --batch-triangles 128 --range-threshold 0.2

Exit code: 0 baked, 1 failed (one line on stderr says why; an older pack stays as it was), 2 wrong usage.)";

std::string check_batch_triangles(const std::string& text) {
  std::uint32_t value = 0;
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

template <int Least, int Most>
std::string check_whole_number(const std::string& text) {
  int value = 0;
  if (!CLI::detail::lexical_cast(text, value) || value < Least || value > Most) {
    return "must be a whole number from " + std::to_string(Least) + " to " + std::to_string(Most) + " (" + text + ")";
  }
  return {};
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  CLI::App app("Bakes glTF scenes into a pack for chandelier-play. Several inputs are merged into one scene.",
               "chandelier-bake");
  app.footer(kExamples);
  app.add_option("SCENE", options.inputs, "glTF 2.0 files, .gltf or .glb")->required();
  app.add_option("-o,--output", options.output, "The pack to write, PACK.chandelier")->required();
  app.add_option("--batch-triangles", options.bake.batch_triangles,
                 "Most triangles in a batch, a multiple of 4 up to 512")
      ->capture_default_str()
      ->check(CLI::Validator(check_batch_triangles, ""));
  app.add_option("--range-threshold", options.bake.range_threshold_lx,
                 "A light without a range ends where its illuminance is this, lux")
      ->capture_default_str()
      ->check(CLI::Validator(check_range_threshold, ""));
  app.add_option("--position-error", options.bake.position_error_m,
                 "Most that a vertex may be moved to store it in fewer bits, metres; 0 moves none")
      ->capture_default_str()
      ->check(CLI::Validator(check_position_error, ""));
  app.add_option("--normal-bits", options.bake.normal_bits, "Bits of each of a normal's two numbers, 8 to 16")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<8, 16>, ""));
  app.add_option("--uv-bits", options.bake.uv_bits,
                 "Bits of a texture coordinate after the point, up to 20; 0 keeps them as they are")
      ->capture_default_str()
      ->check(CLI::Validator(check_whole_number<0, 20>, ""));
  app.add_option("--smooth-angle", options.bake.smooth_angle_deg,
                 "Where normals are missing, smooth edges up to this angle, degrees; 0 makes all flat, as glTF asks")
      ->capture_default_str()
      ->check(CLI::Validator(check_smooth_angle, ""));
  app.add_flag("-q,--quiet", options.quiet, "No progress and no summary; warnings and errors stay");
  try {
    app.parse(argc, argv);
    return options;
  } catch (const CLI::CallForHelp& help) {
    exit_code = app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::cerr << "chandelier-bake: error: " << printable(error.what()) << " (--help explains)\n";
    exit_code = 2;
  }
  return std::nullopt;
}

}  // namespace chandelier::baker
