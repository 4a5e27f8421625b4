// SPDX-License-Identifier: Apache-2.0
// The report as JSON, indented, in a fixed order.
#include "report_json.h"

#include <sys/resource.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

namespace chandelier::baker {
namespace {

using Json = nlohmann::ordered_json;

uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

Json paths_json(const std::vector<std::filesystem::path>& paths) {
  Json out = Json::array();
  for (const std::filesystem::path& path : paths) out.push_back(path.string());
  return out;
}

/// A number without a fraction as JSON's integer.
Json number_json(double value) {
  const auto whole = static_cast<int64_t>(value);
  return value == static_cast<double>(whole) ? Json(whole) : Json(value);
}

Json pass_json(const PassReport& pass) {
  Json counts = Json::object();
  for (const auto& [what, value] : pass.counts) counts[what] = number_json(value);
  Json out = {{"name", pass.name}, {"ms", pass.ms}, {"bytes", pass.bytes}, {"counts", counts}};
  if (pass.cached) out["cached"] = true;
  return out;
}

Json cache_json(const Options& options, const Outcome& outcome) {
  if (options.cache.empty()) return nullptr;
  Json stages = Json::array();
  size_t hits = 0;
  for (const auto& [entry, hit] : outcome.cache_loads) {
    stages.push_back({{"entry", entry}, {"hit", hit}});
    hits += hit;
  }
  return {{"folder", options.cache.string()},
          {"hits", hits},
          {"misses", outcome.cache_loads.size() - hits},
          {"stages", stages}};
}

}  // namespace

std::string report_json(const Options& options, const Outcome& outcome) {
  Json settings = Json::object();
  for (const auto& [name, value] : options.settings) settings[name] = value;
  Json passes = Json::array();
  for (const PassReport& pass : outcome.report.passes) passes.push_back(pass_json(pass));
  const Json report = {
      {"program", "chandelier-bake"},
      {"version", CHANDELIER_VERSION},
      {"inputs", paths_json(options.inputs)},
      {"files_read", paths_json(outcome.files_read)},
      {"output", options.output.string()},
      {"settings", settings},
      {"threads", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)},
      {"seconds", outcome.seconds},
      {"peak_memory_bytes", peak_memory_bytes()},
      {"pack_bytes", outcome.pack_bytes},
      {"triangles", outcome.triangles},
      {"instanced_triangles", outcome.instanced_triangles},
      {"batches", outcome.batches},
      {"images", outcome.images},
      {"lights", outcome.lights},
      {"passes", passes},
      {"cache", cache_json(options, outcome)},
      {"warnings", outcome.warnings},
  };
  // Names that are not UTF-8 get replacement characters: a report is for reading, not for opening files.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace chandelier::baker
