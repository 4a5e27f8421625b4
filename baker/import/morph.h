// SPDX-License-Identifier: Apache-2.0
// Morph targets, as the file's own weights have them.
#pragma once

#include <span>

#include "vertices.h"

namespace chandelier::baker {

/// The weights of the mesh that a node shows: its own, else the mesh's. Empty where all are 0: the base mesh.
std::vector<double> morph_weights(const Gltf& gltf, std::size_t node);

/// Adds what a primitive's targets move to `morphed`, in vertices, before anything of it is read. Throws Error where
/// weights do not suit targets, or above 2^30.
void add_morph_size(const Gltf& gltf, const tinygltf::Primitive& primitive, std::span<const double> weights,
                    const std::string& where, std::uint64_t& morphed);

/// Moves the primitive's vertices by its targets, each times its weight. Returns whether a normal has no direction any
/// more. Throws Error.
bool apply_morphs(const VertexSource& source, Primitive& out);

/// The first attribute that targets with a weight change and that keeps its base, or "".
std::string unread_morph(const VertexSource& source);

}  // namespace chandelier::baker
