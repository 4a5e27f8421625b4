// SPDX-License-Identifier: Apache-2.0
// Which of a glTF's scenes is imported.
#pragma once

#include <cstddef>
#include <optional>

#include "gltf.h"

namespace chandelier::baker {

struct ChosenScene {
  std::optional<size_t> number;  // nothing where the file has no scenes
  bool asked_for = false;        // it is the one that was asked for
  size_t left_out = 0;           // how many others there are
};

/// The scene whose name or number is `asked`. If `asked` is empty, or a file with one scene does not have it, the
/// default scene, or the first one. Warns of the scenes that a default leaves out. Throws Error if a file with several
/// scenes does not have `asked`.
ChosenScene choose_scene(const Gltf& gltf, const std::string& asked, Warnings& warnings);

}  // namespace chandelier::baker
