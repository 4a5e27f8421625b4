// SPDX-License-Identifier: Apache-2.0
// Image files of the player. PNG comes from stb in every build; EXR from OpenImageIO, which the portable build lacks.
#include "player/image_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#ifndef CHANDELIER_PORTABLE
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#endif

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace chandelier::player {
namespace {

namespace fs = std::filesystem;

std::runtime_error cannot_write(const fs::path& path, int error) {
  return std::runtime_error(fmt::format("{}: cannot write ({})", path.string(), std::strerror(error)));
}

// Closes and, unless kept, removes a file being written.
struct Draft {
  fs::path path;
  int descriptor = -1;
  bool kept = false;
  ~Draft() {
    if (descriptor >= 0) ::close(descriptor);
    if (!kept) ::unlink(path.c_str());
  }
};

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

bool written_in_place(const fs::path& path) {
  std::error_code none;
  const fs::file_status status = fs::status(path, none);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::vector<float> radiance_rgb(const Picture& picture) {
  const size_t count = size_t{picture.width} * picture.height;
  std::vector<float> rgb(3 * count);
  for (size_t i = 0; i < count; ++i) std::copy_n(&picture.radiance[4 * i], 3, &rgb[3 * i]);
  return rgb;
}

void write_pfm(const fs::path& path, const Picture& picture) {
  static_assert(std::endian::native == std::endian::little, "the scale below says little endian");
  const std::vector<float> rgb = radiance_rgb(picture);
  std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", picture.width, picture.height);
  const size_t row_bytes = size_t{picture.width} * 3 * sizeof(float);
  for (uint32_t y = picture.height; y-- > 0;)  // PFM starts at the bottom
    bytes.append(reinterpret_cast<const char*>(rgb.data()) + y * row_bytes, row_bytes);
  write_file(path, bytes);
}

void write_exr([[maybe_unused]] const fs::path& path, [[maybe_unused]] const Picture& picture) {
#ifndef CHANDELIER_PORTABLE
  const std::vector<float> rgb = radiance_rgb(picture);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // the default is the time of writing, but the same picture must give the same bytes
  const auto output = OIIO::ImageOutput::create("memory.exr", &memory);
  if (!output || !output->open("memory.exr", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, rgb.data()) ||
      !output->close())
    throw std::runtime_error(
        fmt::format("{}: cannot encode ({})", path.string(), output ? output->geterror() : OIIO::geterror()));
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
#endif
}

}  // namespace

std::optional<ImageKind> image_kind(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".png") return ImageKind::png;
  if (extension == ".pfm") return ImageKind::pfm;
#ifndef CHANDELIER_PORTABLE
  if (extension == ".exr") return ImageKind::exr;
#endif
  return std::nullopt;
}

std::string image_kinds_text() {
#ifdef CHANDELIER_PORTABLE
  return ".png or .pfm";
#else
  return ".png, .exr or .pfm";
#endif
}

void write_picture(const fs::path& path, const Picture& picture) {
  switch (image_kind(path).value()) {
    case ImageKind::exr:
      return write_exr(path, picture);
    case ImageKind::pfm:
      return write_pfm(path, picture);
    case ImageKind::png:
      break;
  }
  std::vector<uint8_t> rgb(size_t{picture.width} * picture.height * 3);
  for (size_t i = 0; i < rgb.size() / 3; ++i) std::copy_n(&picture.shown[4 * i], 3, &rgb[3 * i]);
  write_png(path, picture.width, picture.height, rgb);
}

void write_png(const fs::path& path, uint32_t width, uint32_t height, std::span<const uint8_t> rgb) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  if (stbi_write_png_to_func(append, &bytes, static_cast<int>(width), static_cast<int>(height), 3, rgb.data(),
                             static_cast<int>(width * 3)) == 0)
    throw std::runtime_error(fmt::format("{}: cannot encode ({}x{})", path.string(), width, height));
  write_file(path, bytes);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error(fmt::format("{}: cannot make the folder ({})", folder.string(),
                                         error ? error.message() : "something else is there"));
}

void write_file(const fs::path& path, std::string_view bytes) {
  Draft draft;
  draft.kept = written_in_place(path);
  draft.path = draft.kept ? path : fs::path(fmt::format("{}.part-{}", path.string(), ::getpid()));
  draft.descriptor = ::open(draft.path.c_str(), O_WRONLY | O_CLOEXEC | (draft.kept ? 0 : O_CREAT | O_EXCL), 0666);
  if (draft.descriptor < 0) {
    const int error = errno;
    draft.kept = true;  // nothing was created, and the file there is not ours
    throw cannot_write(path, error);
  }
  if (!write_all(draft.descriptor, bytes)) throw cannot_write(path, errno);
  if (::close(std::exchange(draft.descriptor, -1)) != 0) throw cannot_write(path, errno);
  if (draft.kept) return;
  if (::rename(draft.path.c_str(), path.c_str()) != 0) throw cannot_write(path, errno);
  draft.kept = true;
}

void check_writable(const fs::path& path) {
  if (written_in_place(path)) return;
  std::error_code none;
  if (fs::is_directory(path, none)) throw cannot_write(path, EISDIR);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw cannot_write(path, errno);
  if (!fs::is_directory(folder, none)) throw cannot_write(path, ENOTDIR);
}

}  // namespace chandelier::player
