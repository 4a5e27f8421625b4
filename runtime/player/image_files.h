// SPDX-License-Identifier: Apache-2.0
// Pictures as files: PNG as shown, EXR and PFM as linear radiance. A file appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "frame/renderer.h"

namespace chandelier::player {

enum class ImageKind { png, exr, pfm };

/// By extension, in any case; empty if this build cannot write it.
std::optional<ImageKind> image_kind(const std::filesystem::path& path);
/// ".png, .exr or .pfm": what image_kind() knows.
std::string image_kinds_text();

/// Writes it as its extension says. Throws std::runtime_error, one line.
void write_picture(const std::filesystem::path& path, const Picture& picture);
/// `rgb` holds 8 bits a channel, rows from the top.
void write_png(const std::filesystem::path& path, uint32_t width, uint32_t height, std::span<const uint8_t> rgb);

/// Writes beside `path` and renames, so a failure leaves the older file. What is not a regular file (/dev/stdout) is
/// written in place. Throws std::runtime_error, one line.
void write_file(const std::filesystem::path& path, std::string_view bytes);
/// Makes a folder, and those above it, unless it is there. Throws std::runtime_error.
void make_folder(const std::filesystem::path& folder);
/// Throws std::runtime_error if write_file() cannot make `path`. Call it before long work.
void check_writable(const std::filesystem::path& path);

}  // namespace chandelier::player
