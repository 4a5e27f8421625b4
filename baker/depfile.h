// SPDX-License-Identifier: Apache-2.0
// The list of files that a bake read, for Ninja and Make.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace chandelier::baker {

/// `target: input …` in the syntax that GNU Make, Ninja and CMake read. Each file is named once. Throws Error for a
/// name that the syntax cannot hold.
std::string depfile_text(const std::filesystem::path& target, const std::vector<std::filesystem::path>& inputs);

}  // namespace chandelier::baker
