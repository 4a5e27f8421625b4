// SPDX-License-Identifier: Apache-2.0
#include "file_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string_view>

#include "pack_schema.h"

namespace chandelier::pack {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view by_blender = "open it in Blender and export glTF (File, Export, glTF 2.0)";
constexpr std::string_view by_addon =
    "export glTF from Blender (File, Export, glTF 2.0; Lights ticked), or use Chandelier's add-on";

struct Signature {
  std::string_view bytes;
  std::string_view name;
  std::string_view advice;
  size_t offset = 0;
};
constexpr std::array signatures{
    Signature{"BLENDER"sv, "a Blender file", by_addon},
    Signature{"Kaydara FBX"sv, "an FBX model", by_blender},
    Signature{"PXR-USDC"sv, "a USD scene", by_blender},
    Signature{"#usda"sv, "a USD scene", by_blender},
    Signature{"ply\n"sv, "a PLY model", by_blender},
    Signature{"solid "sv, "an STL model", by_blender},
    Signature{"mtllib "sv, "an OBJ model", by_blender},
    Signature{"<?xml"sv, "an XML file", ""},
    Signature{"PK\3\4"sv, "a zip archive", "unpack it"},
    Signature{"\x1f\x8b"sv, "a compressed file (gzip)", "unpack it"},
    Signature{"\x28\xb5\x2f\xfd"sv, "a compressed file (Zstandard)", "unpack it"},
    Signature{"\x89PNG"sv, "an image (PNG)", ""},
    Signature{"\xff\xd8\xff"sv, "an image (JPEG)", ""},
    Signature{"\x76\x2f\x31\x01"sv, "an image (OpenEXR)", ""},
    Signature{"#?R"sv, "an image (Radiance HDR)", ""},
    Signature{"WEBP"sv, "an image (WebP)", "", 8},
    Signature{"GIF8"sv, "an image (GIF)", ""},
    Signature{"II*\0"sv, "an image (TIFF)", ""},
    Signature{"MM\0*"sv, "an image (TIFF)", ""},
    Signature{"DDS "sv, "an image (DDS)", ""},
    Signature{"\xabKTX"sv, "an image (KTX)", ""},
    Signature{"\x7f"
              "ELF"sv,
              "a program", ""},
};

bool is_text_of(std::string_view text, char first) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  const auto start = std::ranges::find_if(text, [](unsigned char c) { return std::isspace(c) == 0; });
  return start != text.end() && *start == first;
}

/// Quotes a word for the shell if necessary.
std::string quoted(const std::string& word) {
  const bool is_plain = std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || "/._-+,@%"sv.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (is_plain) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string hex(std::span<const std::byte> bytes) {
  std::string out;
  for (const std::byte byte : bytes) {
    char digits[4];
    std::snprintf(digits, sizeof digits, " %02x", std::to_integer<unsigned>(byte));
    out += digits;
  }
  return out;
}

}  // namespace

KnownFile known_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(magic)) return {FileKind::pack, "a Chandelier pack", ""};
  if (text.starts_with("glTF")) return {FileKind::gltf, "a glTF binary", ""};
  if (is_text_of(text, '{'))
    return text.find("\"asset\"") != text.npos ? KnownFile{FileKind::gltf, "a glTF", ""}
                                               : KnownFile{FileKind::json, "a JSON file", ""};
  for (const Signature& each : signatures) {
    if (bytes.size() < each.offset || !text.substr(each.offset).starts_with(each.bytes)) continue;
    // Blender compresses its files, if asked to.
    const bool is_blend = path.extension() == ".blend" && each.name.starts_with("a compressed");
    return is_blend ? KnownFile{FileKind::other, "a Blender file", std::string(by_addon)}
                    : KnownFile{FileKind::other, std::string(each.name), std::string(each.advice)};
  }
  return {};
}

std::string no_pack(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const KnownFile is = known_file(path, bytes);
  if (is.kind == FileKind::unknown)
    return "not a Chandelier pack (it begins with" + hex(bytes.first(std::min<size_t>(bytes.size(), 8))) + ")";
  const std::string what = "not a Chandelier pack, but " + is.name;
  const auto bake = [&](const std::filesystem::path& scene) {
    std::filesystem::path pack = path;
    return "chandelier-bake " + quoted(scene.string()) + " -o " +
           quoted(pack.replace_extension(".chandelier").string());
  };
  if (is.kind == FileKind::gltf) return what + ": make a pack of it with " + bake(path);
  if (is.advice.empty()) return what + ": a pack is made by chandelier-bake, of a glTF";
  std::filesystem::path scene = path;
  return what + ": " + is.advice + ", then " + bake(scene.replace_extension(".glb"));
}

}  // namespace chandelier::pack
