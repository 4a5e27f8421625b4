// SPDX-License-Identifier: Apache-2.0
// chandelier-bake: glTF scenes in, one pack out.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <new>

#include "bake/bake.h"
#include "import/import.h"
#include "options.h"
#include "pack_file.h"

namespace {

using namespace chandelier;

void print_summary(const pack::Contents& pack, std::uintmax_t bytes, double seconds) {
  const auto triangles = static_cast<double>(pack.bake_info.unique_triangles);
  const double mean = pack.batches.empty() ? 0 : triangles / static_cast<double>(pack.batches.size());
  fmt::print("{} triangles ({} instanced), {} batches of {:.1f} on average, {} images, {} lights, {} bytes, {:.2f} s\n",
             pack.bake_info.unique_triangles, pack.bake_info.instanced_triangles, pack.batches.size(), mean,
             pack.images.size(), pack.lights.size(), bytes, seconds);
}

void refuse_overwriting_an_input(const baker::Options& options) {
  for (const std::filesystem::path& input : options.inputs) {
    std::error_code error;
    if (std::filesystem::equivalent(input, options.output, error)) {
      baker::fail(options.output.string(), "the output is one of the inputs");
    }
  }
}

void run(const baker::Options& options) {
  const baker::Progress progress(options.quiet);
  refuse_overwriting_an_input(options);
  baker::Scene scene;
  baker::Warnings warnings;
  for (const std::filesystem::path& input : options.inputs) {
    progress.next("reading " + input.string());
    baker::import_gltf(input, scene, warnings);
  }
  const pack::Contents pack = baker::bake(std::move(scene), options.bake, progress);
  progress.next("writing " + options.output.string());
  pack::write(options.output, pack);
  for (const std::string& line : warnings.lines()) fmt::print(stderr, "chandelier-bake: warning: {}\n", line);
  if (!options.quiet) print_summary(pack, std::filesystem::file_size(options.output), progress.seconds());
}

}  // namespace

int main(int argc, char** argv) {
  int exit_code = 0;
  const auto options = baker::parse_options(argc, argv, exit_code);
  if (!options) return exit_code;
  try {
    run(*options);
    return 0;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "chandelier-bake: error: {}: not enough memory\n", options->inputs.front().string());
  } catch (const std::exception& error) {
    fmt::print(stderr, "chandelier-bake: error: {}\n", error.what());
  }
  return 1;
}
