// SPDX-License-Identifier: Apache-2.0
// chandelier-bake: glTF scenes in, one pack out.
#include <fmt/core.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <set>

#include "bake/bake.h"
#include "depfile.h"
#include "import/import.h"
#include "options.h"
#include "pack_file.h"
#include "report_json.h"

namespace {

using namespace chandelier;

using baker::Outcome;
using Shown = baker::Progress::Shown;

void print_summary(const Outcome& outcome) {
  const auto triangles = static_cast<double>(outcome.triangles);
  const double mean = outcome.batches == 0 ? 0 : triangles / static_cast<double>(outcome.batches);
  fmt::print("{} triangles ({} instanced), {} batches of {:.1f} on average, {} images, {} lights, {} bytes, {:.2f} s\n",
             outcome.triangles, outcome.instanced_triangles, outcome.batches, mean, outcome.images, outcome.lights,
             outcome.pack_bytes, outcome.seconds);
}

/// Before a bake that may take minutes: whether its results could be written.
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

Shown shown_progress(const baker::Options& options) {
  if (options.quiet) return Shown::nothing;
  if (options.verbose) return Shown::all_passes;
  return isatty(STDERR_FILENO) ? Shown::rewritten : Shown::slow_passes;
}

/// All that is written besides stdout.
std::vector<std::filesystem::path> outputs_of(const baker::Options& options) {
  std::vector<std::filesystem::path> out = {options.output};
  for (const std::filesystem::path& path : {options.depfile, options.json}) {
    if (!path.empty() && path != "-") out.push_back(path);
  }
  return out;
}

void check_outputs(const baker::Options& options) {
  std::set<std::filesystem::path> seen;
  for (const std::filesystem::path& output : outputs_of(options)) {
    check_output(output);
    if (!seen.insert(std::filesystem::weakly_canonical(output)).second) {
      baker::fail(output.string(), "is named as two outputs");
    }
  }
}

pack::Contents make_pack(const baker::Options& options, const baker::Progress& progress, baker::Warnings& warnings,
                         baker::Cache& cache, Outcome& outcome) {
  baker::Scene scene;
  outcome.report.run("import", [&](baker::PassReport&) {
    for (const std::filesystem::path& input : options.inputs) {
      progress.next("reading " + input.string());
      with_memory_for(input.string(), [&] { baker::import_gltf(input, scene, warnings); });
    }
  });
  outcome.files_read = scene.files_read;
  for (const auto& output : outputs_of(options)) refuse_overwriting_an_input(outcome.files_read, output);
  return with_memory_for(
      "scene", [&] { return baker::bake(std::move(scene), options.bake, progress, outcome.report, warnings, &cache); });
}

/// The check runs while the disk takes what was written. The depfile comes before the pack is in its place: with the
/// new pack and the old depfile, a file that is newly read could change unnoticed.
void write_pack(const baker::Options& options, const pack::Contents& pack, Outcome& outcome) {
  std::optional<pack::Writer> writer;
  outcome.report.run("write", [&](baker::PassReport&) {
    writer.emplace(options.output, pack, options.compress ? pack::Compression::smallest : pack::Compression::off);
  });
  with_memory_for("scene", [&] { baker::check(pack, outcome.report); });
  if (!options.depfile.empty()) {
    pack::write_text(options.depfile, baker::depfile_text(options.output, outcome.files_read));
  }
  outcome.report.run("sync", [&](baker::PassReport& pass) {
    writer->commit();
    pass.bytes = outcome.pack_bytes = std::filesystem::file_size(options.output);
  });
  outcome.triangles = pack.bake_info.unique_triangles;
  outcome.instanced_triangles = pack.bake_info.instanced_triangles;
  outcome.batches = pack.batches.size();
  outcome.images = pack.images.size();
  outcome.lights = pack.lights.size();
}

void tell(const baker::Options& options, const Outcome& outcome) {
  for (const std::string& line : outcome.warnings) fmt::print(stderr, "chandelier-bake: warning: {}\n", line);
  if (options.json == "-") {
    fmt::print("{}", baker::report_json(options, outcome));
    return;
  }
  if (!options.json.empty()) pack::write_text(options.json, baker::report_json(options, outcome));
  if (!options.quiet) print_summary(outcome);
}

void run(const baker::Options& options) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }
  const baker::Progress progress(shown_progress(options));
  check_outputs(options);
  for (const auto& output : outputs_of(options)) {
    pack::remove_stale_files(output.has_parent_path() ? output.parent_path() : ".");
  }
  Outcome outcome;
  outcome.report.progress = &progress;
  baker::Warnings warnings;
  baker::Cache cache = options.cache.empty() ? baker::Cache() : baker::Cache(options.cache);
  const pack::Contents pack = make_pack(options, progress, warnings, cache, outcome);
  write_pack(options, pack, outcome);
  cache.warn(warnings);
  outcome.cache_loads = cache.loads();
  outcome.warnings = warnings.lines();
  outcome.seconds = progress.seconds();
  progress.clear();
  tell(options, outcome);
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
