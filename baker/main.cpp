// SPDX-License-Identifier: Apache-2.0
// chandelier-bake: glTF scenes in, one pack out.
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
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

/// Before a bake that may take minutes: whether its pack could be written.
void check_output(const std::filesystem::path& output) {
  std::error_code error;
  const std::string folder = output.has_parent_path() ? output.parent_path().string() : ".";
  if (std::filesystem::is_directory(output, error)) baker::fail(output.string(), "the output is a folder");
  if (!std::filesystem::is_directory(folder, error)) {
    baker::fail(output.string(), "there is no such folder (" + folder + ")");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    baker::fail(output.string(),
                std::string("cannot write into its folder: ") + std::strerror(errno) + " (" + folder + ")");
  }
}

/// The glTFs, their buffers and their images.
void refuse_overwriting_an_input(const std::vector<std::filesystem::path>& files, const std::filesystem::path& output) {
  for (const std::filesystem::path& file : files) {
    std::error_code error;
    if (std::filesystem::equivalent(file, output, error)) {
      baker::fail(output.string(), "the output is one of the inputs (" + file.string() + ")");
    }
  }
}

/// `work`, with `where` told where memory runs out.
template <typename Work>
auto with_memory_for(const std::string& where, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    baker::fail(where, "not enough memory");
  }
}

void run(const baker::Options& options) {
  const baker::Progress progress(!options.quiet && isatty(STDERR_FILENO));
  check_output(options.output);
  baker::Scene scene;
  baker::Warnings warnings;
  for (const std::filesystem::path& input : options.inputs) {
    progress.next("reading " + input.string());
    with_memory_for(input.string(), [&] { baker::import_gltf(input, scene, warnings); });
  }
  refuse_overwriting_an_input(scene.files_read, options.output);
  baker::Report report;
  const pack::Contents pack = with_memory_for(
      "scene", [&] { return baker::bake(std::move(scene), options.bake, progress, report, warnings); });
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
  } catch (const std::exception& error) {
    fmt::print(stderr, "chandelier-bake: error: {}\n", baker::printable(error.what()));
  }
  return 1;
}
