// SPDX-License-Identifier: Apache-2.0
// Parts of check_gltf in other files. Each checks one entry of a section; all throw Error.
#pragma once

#include "json_object.h"

namespace chandelier::baker {

/// Extensions.
void check_meshopt_view(const Json& root, const Object& view);        // EXT_meshopt_compression
void check_draco(const Json& root, const Object& primitive);          // KHR_draco_mesh_compression
void check_texture_transform(const Object& use);                      // KHR_texture_transform
void check_texture_sources(const Json& root, const Object& texture);  // KHR_texture_basisu, EXT_texture_webp
void check_instancing(const Json& root, const Object& node);          // EXT_mesh_gpu_instancing

/// Animations and skins.
void check_animation(const Json& root, const Object& animation);
void check_skin(const Json& root, const Object& skin);

/// The name of the extension that compresses a buffer view, or nullptr. KHR_meshopt_compression has the same layout.
const char* meshopt_extension(const Json& buffer_view);

}  // namespace chandelier::baker
