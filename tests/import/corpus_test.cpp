// SPDX-License-Identifier: Apache-2.0
// Public models and a validator's collection of broken ones, where the test data is.
#include <gtest/gtest.h>

#include <algorithm>

#include "gltf_builder.h"

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

bool lacks_an_extension(const std::string& line) {
  return line.find(": extensionsRequired: unknown extension (") != std::string::npos;
}

TEST(Corpus, BakesTheKhronosModelsOrNamesTheExtensionItLacks) {
  const std::filesystem::path folder = kData / "models" / "khronos";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::size_t baked = 0;
  for (const std::filesystem::path& path : gltfs_below(folder)) {
    const std::string line = error_of(path);
    baked += line.empty();
    // AnisotropyBarnLamp asks for KTX2 images without requiring the extension that has them.
    const bool is_ktx2 = line.find("is neither PNG nor JPEG but KTX2") != std::string::npos;
    EXPECT_TRUE(line.empty() || lacks_an_extension(line) || is_ktx2) << line;
  }
  EXPECT_GE(baked, 40u);
}

TEST(Corpus, BakesTheKitsAndTheOtherModels) {
  if (!std::filesystem::exists(kData / "kits")) GTEST_SKIP() << "no " << kData / "kits";
  std::size_t baked = 0;
  for (const char* folder : {"kits", "models"}) {
    for (const std::filesystem::path& path : gltfs_below(kData / folder)) {
      if (path.string().rfind((kData / "models" / "khronos").string(), 0) == 0) continue;
      const std::string line = error_of(path);
      baked += line.empty();
      EXPECT_TRUE(line.empty() || lacks_an_extension(line)) << line;
    }
  }
  EXPECT_GE(baked, 400u);
}

TEST(Corpus, RefusesOrBakesEveryFileOfTheValidatorsTests) {
  const std::filesystem::path folder = kData / "conformance" / "gltf-validator-base";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::size_t refused = 0, files = 0;
  for (const std::filesystem::path& path : gltfs_below(folder)) {
    SCOPED_TRACE(path.string());
    ++files;
    const std::string line = error_of(path);  // another exception than Error fails the test
    refused += !line.empty();
    if (line.empty()) continue;
    EXPECT_EQ(line.rfind(path.string() + ": ", 0), 0u) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
  EXPECT_GT(files, 100u);
  EXPECT_GT(refused, files / 4);
}

}  // namespace
}  // namespace chandelier::baker::test
