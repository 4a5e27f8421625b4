// SPDX-License-Identifier: Apache-2.0
// Public models and a validator's collection of broken ones, where the test data is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

const std::filesystem::path kData = CHANDELIER_DATA_DIR;

std::vector<std::filesystem::path> gltfs_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".gltf" || extension == ".glb")) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

struct Verdict {
  std::string error;
  std::vector<std::string> warnings;

  const char* name() const { return !error.empty() ? "refused" : warnings.empty() ? "baked" : "baked with a warning"; }
};

Verdict bake_file(const std::filesystem::path& path) {
  Verdict out;
  Warnings warnings;
  try {
    Scene scene;
    import_gltf(path, scene, warnings);
    Report report;
    check(bake(std::move(scene), {}, Progress(false), report, warnings), report);
  } catch (const Error& error) {  // another exception fails the test
    out.error = error.what();
  }
  out.warnings = warnings.lines();
  return out;
}

/// Every file below `folder` bakes; returns how many there are.
std::size_t bake_all(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> paths = gltfs_below(folder);
  std::size_t warned = 0;
  for (const std::filesystem::path& path : paths) {
    const Verdict verdict = bake_file(path);
    EXPECT_EQ(verdict.error, "");
    warned += !verdict.warnings.empty();
  }
  std::printf("%zu baked, %zu of them with a warning: %s\n", paths.size(), warned, folder.filename().c_str());
  return paths.size();
}

TEST(Corpus, BakesTheKhronosModels) {
  const std::filesystem::path folder = kData / "models" / "khronos";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  EXPECT_GE(bake_all(folder), 40u);
}

TEST(Corpus, BakesTheKitsAndTheOtherModels) {
  if (!std::filesystem::exists(kData / "kits")) GTEST_SKIP() << "no " << kData / "kits";
  std::size_t baked = bake_all(kData / "kits");
  for (const auto& entry : std::filesystem::directory_iterator(kData / "models")) {
    if (entry.is_directory() && entry.path().filename() != "khronos") baked += bake_all(entry.path());
  }
  EXPECT_GE(baked, 400u);
}

/// Errors of the validator that a bake need not tell, as baker/README.md says: by code, why they do no harm.
const std::map<std::string, std::string> kHarmless = {
    {"ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND", "bounds are computed anew"},
    {"ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "bounds are computed anew"},
    {"ACCESSOR_MAX_MISMATCH", "bounds are computed anew"},
    {"ACCESSOR_MIN_MISMATCH", "bounds are computed anew"},
    {"ACCESSOR_INVALID_FLOAT", "an error where something drawn uses it; else not read"},
    {"ACCESSOR_INVALID_IBM", "an error where something drawn uses it; else not read"},
    {"ACCESSOR_INDEX_OOB", "an error where something drawn uses it; else not read"},
    {"ACCESSOR_INDEX_PRIMITIVE_RESTART", "an error where something drawn uses it; else not read"},
    {"ACCESSOR_NON_CLAMPED", "colours are clamped"},
    {"ACCESSOR_INVALID_SIGN", "a tangent's sign is taken as a sign"},
    {"ACCESSOR_VECTOR3_NON_UNIT", "normals and tangents are made unit length"},
    {"IMAGE_DATA_INVALID", "an error where something drawn uses it; else not read"},
    {"IMAGE_UNEXPECTED_EOS", "an error where something drawn uses it; else not read"},
    {"IMAGE_MIME_TYPE_INVALID", "an image's own bytes say what it is"},
    {"INVALID_URI", "an error where something drawn uses it; else not read"},
    {"IO_ERROR", "an error where something drawn uses it; else not read"}};

/// The validator's errors in a report, each code once.
std::set<std::string> errors_in(const std::filesystem::path& report) {
  std::ifstream file(report);
  std::set<std::string> out;
  const Json issues = Json::parse(file)["issues"];
  for (const Json& message : issues["messages"]) {
    if (message["severity"] == 0) out.insert(message["code"].get<std::string>());
  }
  return out;
}

bool all_harmless(const std::set<std::string>& codes) {
  return std::all_of(codes.begin(), codes.end(), [](const std::string& code) { return kHarmless.contains(code); });
}

// One line per file: what the validator says, what the baker does.
TEST(Corpus, JudgesTheValidatorsFilesByTheRule) {
  const std::filesystem::path folder = kData / "conformance" / "gltf-validator-base";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::map<std::string, std::size_t> counts;
  for (const std::filesystem::path& path : gltfs_below(folder)) {
    const std::filesystem::path report = path.string() + ".report.json";
    if (!std::filesystem::exists(report)) continue;
    const std::string name = std::filesystem::relative(path, folder / "test/base/data").string();
    const std::set<std::string> codes = errors_in(report);
    const Verdict verdict = bake_file(path);
    std::string list;
    for (const std::string& code : codes) list += " " + code;
    std::printf("%-50s %-20s%s\n", name.c_str(), verdict.name(), codes.empty() ? " valid" : list.c_str());
    ++counts[verdict.name()];
    if (codes.empty()) EXPECT_EQ(verdict.error, "") << name << " is valid";
    const bool silent = verdict.error.empty() && verdict.warnings.empty();
    if (silent) EXPECT_TRUE(all_harmless(codes)) << name << " is baked silently";
    if (verdict.error.empty()) continue;
    EXPECT_EQ(verdict.error.rfind(path.string() + ": ", 0), 0u) << verdict.error;
    EXPECT_EQ(verdict.error.find('\n'), std::string::npos) << verdict.error;
  }
  for (const auto& [verdict, count] : counts) std::printf("%zu %s\n", count, verdict.c_str());
  EXPECT_GT(counts["refused"], 60u);
  EXPECT_GT(counts["baked"], 50u);
}

}  // namespace
}  // namespace chandelier::baker::test
