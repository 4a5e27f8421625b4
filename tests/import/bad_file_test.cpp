// SPDX-License-Identifier: Apache-2.0
// Files that are no glTF, and files that a glTF names and that cannot be read.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

std::string error_of_text(const std::string& text) {
  const std::filesystem::path path = scratch_folder() / "text.gltf";
  write_bytes(path, text);
  const std::string line = error_of(path);
  EXPECT_EQ(line.rfind(path.string() + ": ", 0), 0u) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos);
  return line.substr(std::min(line.size(), path.string().size() + 2));
}

TEST(BadInput, IsNamedWhereItIsNoGltf) {
  EXPECT_EQ(error_of_text(""), "is not a glTF: it is empty");
  EXPECT_EQ(error_of_text("[]"), "is not a glTF: the JSON is not an object");
  EXPECT_EQ(error_of_text("hello").rfind("is not a glTF: parse error at line 1, column 1", 0), 0u);
  EXPECT_EQ(error_of_text("\x89PNG\r\n\x1a\n").rfind("is not a glTF: ", 0), 0u);
  EXPECT_EQ(error_of_text("{\"asset\": {\"version\": \"2.0\"}").rfind("is not a glTF: parse error", 0), 0u);
  EXPECT_EQ(error_of_text(std::string(100000, '[')), "JSON is nested too deeply (more than 200)");
}

TEST(BadInput, IsNamedWhereAFileIsMissing) {
  const std::filesystem::path path = scratch_folder() / "nowhere.gltf";
  EXPECT_EQ(error_of(path), path.string() + ": no such file (" + path.string() + ")");
  EXPECT_EQ(error_of(scratch_folder()),
            scratch_folder().string() + ": is not a file (" + scratch_folder().string() + ")");
}

/// The error for a triangle whose buffer has this uri.
std::string buffer_error(const std::string& uri) {
  GltfBuilder gltf = one_triangle();
  gltf.json["buffers"] = {{{"byteLength", gltf.bytes.size()}, {"uri", uri}}};
  gltf.bytes.clear();
  const std::filesystem::path path = gltf.save("buffer");
  return error_of(path).substr(path.string().size() + 2);
}

TEST(BadInput, IsNamedWhereABufferCannotBeRead) {
  EXPECT_EQ(buffer_error("gone.bin"), "buffer 0: no such file (" + (scratch_folder() / "gone.bin").string() + ")");
  EXPECT_EQ(buffer_error("http://example.org/a.bin"),
            "buffer 0: URI is not relative to the file (http://example.org/a.bin)");
  EXPECT_EQ(buffer_error("file:///etc/hostname"), "buffer 0: URI is not relative to the file (file:///etc/hostname)");
  EXPECT_EQ(buffer_error("/etc/hostname"), "buffer 0: URI is not relative to the file (/etc/hostname)");
  EXPECT_EQ(buffer_error(""), "buffer 0: URI names no file ()");
  EXPECT_EQ(buffer_error("a%0Ab.bin"), "buffer 0: no such file (" + (scratch_folder() / "a").string() + "\\nb.bin)");
  EXPECT_EQ(buffer_error("a%00b"), "buffer 0: URI names no file (a%00b)");
  EXPECT_EQ(buffer_error("data:application/octet-stream;base64,AAAA"),
            "buffer 0: is shorter than its byteLength 42 (3 bytes)");
  EXPECT_EQ(buffer_error("data:application/octet-stream;base64,A*"), "buffer 0: data URI is not base64 ('*')");
  EXPECT_EQ(buffer_error("data:nothing"), "buffer 0: data URI has no data (data:nothing)");
  write_bytes(scratch_folder() / "short.bin", "12345");
  EXPECT_EQ(buffer_error("short.bin"), "buffer 0: is shorter than its byteLength 42 (5 bytes)");
}

TEST(BadInput, IsNamedWhereAnImageCannotBeRead) {
  GltfBuilder gltf = one_triangle();
  gltf.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  const auto error = [&](const Json& image) {
    gltf.json["images"] = {image};
    const std::filesystem::path path = gltf.save("image");
    return error_of(path).substr(path.string().size() + 2);
  };
  EXPECT_EQ(error({{"name", "sky"}}), "image 0 'sky': has neither uri nor bufferView");
  EXPECT_EQ(error({{"uri", "gone.png"}}),
            "image 0 (gone.png): no such file (" + (scratch_folder() / "gone.png").string() + ")");
  write_bytes(scratch_folder() / "text.png", "no picture");
  EXPECT_EQ(error({{"uri", "text.png"}}), "image 0 (text.png): is neither PNG, JPEG nor WebP (10 bytes)");
  EXPECT_EQ(error({{"uri", "a\nb.png"}}),
            "image 0 (a\\nb.png): no such file (" + (scratch_folder() / "a").string() + "\\nb.png)");
  EXPECT_EQ(error({{"bufferView", 7}}), "image 0, bufferView: points past the end, there are 2 (7)");
}

}  // namespace
}  // namespace chandelier::baker::test
