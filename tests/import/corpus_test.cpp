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

const std::filesystem::path data = CHANDELIER_DATA_DIR;

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
size_t bake_all(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> paths = gltfs_below(folder);
  size_t warned = 0;
  for (const std::filesystem::path& path : paths) {
    const Verdict verdict = bake_file(path);
    EXPECT_EQ(verdict.error, "");
    warned += !verdict.warnings.empty();
  }
  std::printf("%zu baked, %zu of them with a warning: %s\n", paths.size(), warned, folder.filename().c_str());
  return paths.size();
}

TEST(Corpus, BakesTheKhronosModels) {
  const std::filesystem::path folder = data / "models" / "khronos";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  EXPECT_GE(bake_all(folder), 40u);
}

TEST(Corpus, BakesTheKitsAndTheOtherModels) {
  if (!std::filesystem::exists(data / "kits")) GTEST_SKIP() << "no " << data / "kits";
  size_t baked = bake_all(data / "kits");
  for (const auto& entry : std::filesystem::directory_iterator(data / "models")) {
    if (entry.is_directory() && entry.path().filename() != "khronos") baked += bake_all(entry.path());
  }
  EXPECT_GE(baked, 400u);
}

/// Errors of the validator that a bake need not tell, as baker/README.md says: by code, why they do no harm.
const std::map<std::string, std::string> harmless = {
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
    {"IO_ERROR", "an error where something drawn uses it; else not read"},
    {"BUFFER_VIEW_TARGET_OVERRIDE", "targets are not read"},
    {"MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "coordinates that lack are 0"}};

/// Of the others, what some warning must say where the file is baked.
const std::multimap<std::string, std::string> told = {
    {"ACCESSOR_ANIMATION_INPUT_NEGATIVE", "a channel whose keys have no data is skipped"},
    {"ACCESSOR_ANIMATION_INPUT_NON_INCREASING", "a channel whose keys have no data is skipped"},
    {"ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION", "a channel whose keys have no data is skipped"},
    {"ACCESSOR_JOINTS_INDEX_DUPLICATE", "points and lines are skipped"},
    {"ACCESSOR_JOINTS_INDEX_OOB", "points and lines are skipped"},
    {"ACCESSOR_MATRIX_ALIGNMENT", "it ends past its buffer view"},
    {"ACCESSOR_NORMALIZED_INVALID", "it is normalized, but not of 8- or 16-bit integers"},
    {"ACCESSOR_OFFSET_ALIGNMENT", "its values are not aligned"},
    {"ACCESSOR_SMALL_BYTESTRIDE", "its elements overlap"},
    {"ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", "it has more sparse elements than elements"},
    {"ACCESSOR_TOO_LONG", "it ends past its buffer view"},
    {"ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "its values are not aligned"},
    {"ACCESSOR_WEIGHTS_NEGATIVE", "points and lines are skipped"},
    {"ACCESSOR_WEIGHTS_NON_NORMALIZED", "points and lines are skipped"},
    {"ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS",
     "animation of something other than a node's transform is skipped"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT", "its times are not floats"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS", "a channel whose keys have no data is skipped"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS", "its times have no bounds"},
    {"ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT", "a channel whose keys have no data is skipped"},
    {"ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT", "a channel whose keys have no data is skipped"},
    {"ASSET_MIN_VERSION_GREATER_THAN_VERSION", "asks for a later glTF than 2.0"},
    {"BUFFER_BYTE_LENGTH_MISMATCH", "cannot be read, but nothing in the scene uses it"},
    {"BUFFER_DATA_URI_MIME_TYPE_INVALID", "the media type of its data URI is not that of a buffer"},
    {"BUFFER_MISSING_GLB_DATA", "has no data: no URI, and no GLB chunk"},
    {"BUFFER_VIEW_INVALID_BYTE_STRIDE", "it has a byteStride, but its target is not vertices"},
    {"BUFFER_VIEW_INVALID_BYTE_STRIDE", "its sparse elements have a byteStride"},
    {"BUFFER_VIEW_TOO_BIG_BYTE_STRIDE", "its byteStride is larger than its byteLength"},
    {"BUFFER_VIEW_TOO_LONG", "it ends past its buffer"},
    {"CAMERA_XMAG_YMAG_ZERO", "its xmag or ymag is 0"},
    {"CAMERA_ZFAR_LEQUAL_ZNEAR", "its zfar is not above its znear"},
    {"DUPLICATE_ELEMENTS", "it names an extension twice"},
    {"EMPTY_ENTITY", "an array is empty"},
    {"GLB_CHUNK_LENGTH_UNALIGNED", "its length is not a multiple of 4"},
    {"GLB_DUPLICATE_CHUNK", "a second or misplaced chunk is ignored"},
    {"GLB_UNEXPECTED_BIN_CHUNK", "a second or misplaced chunk is ignored"},
    {"IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE", "its buffer view has a byteStride"},
    {"INVALID_IBM_ACCESSOR_COUNT", "its inverseBindMatrices are not one 4x4 float matrix per joint"},
    {"INVALID_JSON", "it begins with a byte order mark"},
    {"MESH_INVALID_WEIGHTS_COUNT", "its weights are not one per morph target"},
    {"MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT", "its primitives have different numbers of morph targets"},
    {"MESH_PRIMITIVE_ACCESSOR_UNALIGNED", "an attribute is not aligned to 4 bytes"},
    {"MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE", "it has several attributes and no byteStride"},
    {"MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", "POSITION or NORMAL is not of three floats"},
    {"MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT", "an attribute is of 32-bit integers"},
    {"MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", "an attribute's sets are not numbered from 0 without gaps"},
    {"MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT", "indices are not of unsigned integers"},
    {"MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE", "indices have a byteStride"},
    {"MESH_PRIMITIVE_INVALID_ATTRIBUTE", "is unknown"},
    {"MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "JOINTS come without WEIGHTS"},
    {"MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
     "a morph target has a different number of elements than its base"},
    {"MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR", "a morph target has an attribute that its base lacks"},
    {"MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "POSITION has no bounds"},
    {"MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", "a primitive's attributes have different counts"},
    {"NODE_MATRIX_TRS", "it has a matrix and also translation, rotation or scale: the matrix is used"},
    {"NODE_SKIN_NO_SCENE", "a joint is not in the scene, so the skin is ignored"},
    {"NODE_SKIN_WITH_NON_SKINNED_MESH", "a skin is ignored: its mesh has vertices without joints"},
    {"ONE_OF_MISMATCH", "it is both perspective and orthographic"},
    {"ONE_OF_MISMATCH", "it does not have exactly one of uri and bufferView"},
    {"ROTATION_NON_UNIT", "its rotation is not of unit length"},
    {"SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE", "its matrices have a byteStride"},
    {"SKIN_IBM_INVALID_FORMAT", "its inverseBindMatrices are not one 4x4 float matrix per joint"},
    {"SKIN_NO_COMMON_ROOT", "its joints have no common root"},
    {"SKIN_SKELETON_INVALID", "its skeleton is not above its joints"},
    {"TYPE_MISMATCH", "unknown extension is ignored"},
    {"UNDECLARED_EXTENSION", "extensionsUsed does not name an extension"},
    {"UNSATISFIED_DEPENDENCY", "it has a byteOffset without a buffer view"},
    {"UNSATISFIED_DEPENDENCY", "it has no mimeType"},
    {"UNSATISFIED_DEPENDENCY", "it has a skin or weights without a mesh"},
    {"VALUE_NOT_IN_RANGE", "it is empty"}};

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

bool is_told(const std::string& code, const std::vector<std::string>& warnings) {
  const auto [first, last] = told.equal_range(code);
  return std::any_of(first, last, [&](const auto& entry) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& warning) { return warning.find(entry.second) != std::string::npos; });
  });
}

// One line per file: what the validator says, what the baker does.
TEST(Corpus, JudgesTheValidatorsFilesByTheRule) {
  const std::filesystem::path folder = data / "conformance" / "gltf-validator-base";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::map<std::string, size_t> counts;
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
    EXPECT_TRUE(!codes.empty() || verdict.error.empty()) << name << " is valid: " << verdict.error;
    if (verdict.error.empty()) {
      for (const std::string& code : codes) {
        EXPECT_TRUE(harmless.contains(code) || is_told(code, verdict.warnings)) << name << " is baked without " << code;
      }
      continue;
    }
    EXPECT_EQ(verdict.error.rfind(path.string() + ": ", 0), 0u) << verdict.error;
    EXPECT_EQ(verdict.error.find('\n'), std::string::npos) << verdict.error;
  }
  for (const auto& [verdict, count] : counts) std::printf("%zu %s\n", count, verdict.c_str());
  EXPECT_GT(counts["refused"], 60u);
  EXPECT_GT(counts["baked"], 50u);
}

}  // namespace
}  // namespace chandelier::baker::test
