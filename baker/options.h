// SPDX-License-Identifier: Apache-2.0
// The command line of chandelier-bake.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/bake.h"
#include "import/import.h"

namespace chandelier::baker {

struct Options {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;
  ImportSettings import;
  BakeSettings bake;
  bool compress = false;                                      // sections take the codecs that make them smallest
  std::vector<std::pair<std::string, std::string>> settings;  // the same as text: each option's name and value
  std::filesystem::path cache;                                // empty: none
  std::filesystem::path depfile;                              // empty: none
  std::filesystem::path json;                                 // empty: none; "-": stdout
  int threads = 0;                                            // 0: all
  bool quiet = false;
  bool verbose = false;
};

/// Returns nothing and sets `exit_code` if there is nothing to bake: --help or --version (0), or a usage error (2).
std::optional<Options> parse_options(int argc, char** argv, int& exit_code);

}  // namespace chandelier::baker
