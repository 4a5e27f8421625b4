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
#include <string>
#include <string_view>

#include "bake/bake.h"
#include "depfile.h"
#include "import/import.h"
#include "options.h"
#include "pack_file.h"
#include "report_json.h"
#include "threads.h"

namespace {

using namespace chandelier;

using baker::Outcome;
using Shown = baker::Progress::Shown;

[[noreturn]] void fail_write(const std::string& where, int error) {
  baker::fail(where, std::string("cannot write: ") + std::strerror(error));
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    fail_write("standard output", errno);
  }
}

/// Writes into a device, a pipe or a socket, which a file cannot replace.
void write_through(const std::filesystem::path& path, std::string_view text) {
  std::FILE* file = std::fopen(path.c_str(), "we");
  if (!file) fail_write(path.string(), errno);
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  const int error = errno;
  std::fclose(file);
  if (!written) fail_write(path.string(), error);
}

bool is_stream(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_other(std::filesystem::status(path, ignored));
}

void print_summary(const Outcome& outcome) {
  const auto triangles = static_cast<double>(outcome.triangles);
  const double mean = outcome.batches == 0 ? 0 : triangles / static_cast<double>(outcome.batches);
  print(fmt::format(
      "{} triangles ({} instanced), {} batches of {:.1f} on average, {} images, {} lights, {} bytes, {:.2f} s\n",
      outcome.triangles, outcome.instanced_triangles, outcome.batches, mean, outcome.images, outcome.lights,
      outcome.pack_bytes, outcome.seconds));
}

/// Checks before the bake, which may take minutes, that its results can be written.
void check_output(const std::filesystem::path& output) {
  std::error_code error;
  const std::string folder = output.has_parent_path() ? output.parent_path().string() : ".";
  const std::filesystem::file_status status = std::filesystem::status(output, error);
  if (status.type() == std::filesystem::file_type::none) {
    baker::fail(output.string(), "cannot be an output: " + error.message());
  }
  if (is_directory(status)) baker::fail(output.string(), "the output is a folder");
  if (is_other(status)) baker::fail(output.string(), "exists and is not a regular file");
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

/// Runs `work`; if memory runs out, the error names `where`.
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

/// All files that are written: not stdout, nor a device or pipe that takes the report.
std::vector<std::filesystem::path> outputs_of(const baker::Options& options) {
  std::vector<std::filesystem::path> out = {options.output};
  for (const std::filesystem::path& path : {options.depfile, options.json}) {
    const bool streamed = path == options.json && (path == "-" || is_stream(path));
    if (!path.empty() && !streamed) out.push_back(path);
  }
  return out;
}

void check_outputs(const baker::Options& options) {
  std::set<std::filesystem::path> seen;
  for (const std::filesystem::path& output : outputs_of(options)) {
    check_output(output);
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(output, error);
    if (error) baker::fail(output.string(), "cannot be an output: " + error.message());
    if (!seen.insert(canonical).second) {
      baker::fail(output.string(), "is used for two outputs");
    }
  }
}

void import_all(const baker::Options& options, const baker::Progress& progress, baker::Scene& scene,
                baker::Warnings& warnings, baker::PassReport& pass) {
  baker::ImportCounts all;
  for (const std::filesystem::path& input : options.inputs) {
    progress.next("reading " + input.string());
    const baker::ImportCounts counts =
        with_memory_for(input.string(), [&] { return baker::import_gltf(input, scene, warnings, options.import); });
    all.has_scene = all.has_scene || counts.has_scene;
    all.hidden_nodes += counts.hidden_nodes;
    all.scenes_left_out += counts.scenes_left_out;
    all.converted_materials += counts.converted_materials;
  }
  if (!options.import.scene.empty() && !all.has_scene) {
    baker::fail("--scene", "no input has such a scene (" + baker::shortened(options.import.scene, 80) + ")");
  }
  pass.count("hidden_nodes", static_cast<double>(all.hidden_nodes));
  pass.count("scenes_left_out", static_cast<double>(all.scenes_left_out));
  pass.count("converted_materials", static_cast<double>(all.converted_materials));
}

/// A pack that shows nothing is most likely a mistake.
void warn_of_nothing(const pack::Contents& pack, baker::Warnings& warnings) {
  if (pack.bake_info.instanced_triangles == 0) {
    warnings.add("scene", "triangles", "there are none, so the pack shows nothing");
  }
  if (pack.lights.empty()) {
    warnings.add("scene", "lights",
                 "there are none, so pictures will be black: bake a glTF with lights as a second input "
                 "(chandelier-bake SCENE LIGHTS -o PACK), or play the pack with --headlight or --ambient");
  }
}

pack::Contents make_pack(const baker::Options& options, const baker::Progress& progress, baker::Warnings& warnings,
                         baker::Cache& cache, Outcome& outcome) {
  baker::Scene scene;
  outcome.report.run("import", [&](baker::PassReport& pass) { import_all(options, progress, scene, warnings, pass); });
  outcome.files_read = scene.files_read;
  for (const auto& output : outputs_of(options)) refuse_overwriting_an_input(outcome.files_read, output);
  pack::Contents pack = with_memory_for(
      "scene", [&] { return baker::bake(std::move(scene), options.bake, progress, outcome.report, warnings, &cache); });
  warn_of_nothing(pack, warnings);
  return pack;
}

/// Writes the temporary file that commit() renames, and fills in `outcome`. The check runs while the disk writes. The
/// depfile is written before the pack gets its name: with a new pack and an old depfile, a change of a newly read file
/// would go unnoticed.
void write_pack(const baker::Options& options, const pack::Contents& pack, std::optional<pack::Writer>& writer,
                Outcome& outcome) {
  outcome.report.run("write", [&](baker::PassReport& pass) {
    const auto compression = options.compress ? pack::Compression::smallest : pack::Compression::off;
    writer.emplace(options.output, pack, compression, baker::most_threads());
    pass.bytes = outcome.pack_bytes = writer->size_bytes();
  });
  baker::check(pack, outcome.report);
  if (!options.depfile.empty()) {
    pack::write_text(options.depfile, baker::depfile_text(options.output, outcome.files_read));
  }
  outcome.report.run("sync", [&](baker::PassReport&) { writer->sync(); });
  outcome.triangles = pack.bake_info.unique_triangles;
  outcome.instanced_triangles = pack.bake_info.instanced_triangles;
  outcome.batches = pack.batches.size();
  outcome.images = pack.images.size();
  outcome.lights = pack.lights.size();
}

/// Prints everything before the pack gets its name, so that a bake that cannot print leaves the older pack. A report's
/// file waits in `file`: it must not describe a pack that was not put in place.
void print_results(const baker::Options& options, const Outcome& outcome, std::optional<pack::TemporaryFile>& file) {
  for (const std::string& line : outcome.warnings) fmt::print(stderr, "chandelier-bake: warning: {}\n", line);
  if (options.json == "-") return print(baker::report_json(options, outcome));
  if (!options.json.empty()) {
    const std::string report = baker::report_json(options, outcome);
    if (is_stream(options.json)) {
      write_through(options.json, report);
    } else {
      file.emplace(options.json).write(0, report.data(), report.size());
      file->sync();
    }
  }
  if (!options.quiet) print_summary(outcome);
}

void run(const baker::Options& options) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(options.threads));
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
  std::optional<pack::Writer> writer;
  with_memory_for(options.output.string(), [&] { write_pack(options, pack, writer, outcome); });
  cache.warn(warnings);
  outcome.cache_loads = cache.loads();
  outcome.warnings = warnings.lines();
  outcome.seconds = progress.seconds();
  progress.clear();
  std::optional<pack::TemporaryFile> report;
  print_results(options, outcome, report);
  writer->commit();
  if (report) report->commit(pack::Sync::yes);
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
