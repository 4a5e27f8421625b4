// SPDX-License-Identifier: Apache-2.0
// Maps files, decodes data URIs, takes other URIs relative to the glTF's folder.
#include "files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "../error.h"

namespace chandelier::baker {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decode(const std::string& uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

/// The start of a URI as a message shows it.
std::string shown_uri(const std::string& uri) {
  return shortened(uri, 80);
}

std::vector<uint8_t> decode_base64(std::string_view text, const std::string& where) {
  std::vector<uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int have = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+' || c == '-') value = 62;
    if (c == '/' || c == '_') value = 63;
    if (value < 0) fail(where, std::string("data URI is not base64 ('") + c + "')");
    bits = bits << 6 | static_cast<uint32_t>(value);
    have += 6;
    if (have >= 8) {
      have -= 8;
      out.push_back(static_cast<uint8_t>(bits >> have));
    }
  }
  return out;
}

std::vector<uint8_t> read_data_uri(const std::string& uri, const std::string& where) {
  const size_t comma = uri.find(',');
  if (comma == std::string::npos) fail(where, "data URI has no data (" + shown_uri(uri) + ")");
  const std::string_view header = std::string_view(uri).substr(0, comma);
  const std::string body = percent_decode(uri.substr(comma + 1));
  if (header.ends_with(";base64")) return decode_base64(body, where);
  return {body.begin(), body.end()};
}

/// "http" of "http://…"; empty for a relative reference.
std::string uri_scheme(const std::string& uri) {
  const size_t end = uri.find_first_of(":/?#");
  return end != std::string::npos && end > 0 && uri[end] == ':' ? uri.substr(0, end) : "";
}

/// Closes a descriptor at the end of a scope.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

}  // namespace

Bytes bytes_of(std::vector<uint8_t>&& data) {
  const auto owner = std::make_shared<const std::vector<uint8_t>>(std::move(data));
  return {*owner, owner};
}

Bytes map_file(const std::filesystem::path& path, const std::string& where) {
  const std::string name = "(" + shortened(path.string(), 400) + ")";
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(where, "no such file " + name);
  if (!std::filesystem::is_regular_file(status)) fail(where, "is not a file " + name);
  const Descriptor file{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat info {};
  if (file.number < 0 || fstat(file.number, &info) != 0) {
    fail(where, "cannot be read: " + std::string(std::strerror(errno)) + " " + name);
  }
  const auto size = static_cast<size_t>(info.st_size);
  if (size == 0) return {};  // cannot be mapped
  void* data = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number, 0);
  if (data == MAP_FAILED) fail(where, "cannot be read: " + std::string(std::strerror(errno)) + " " + name);
  std::shared_ptr<const void> owner(data, [size](const void* start) { munmap(const_cast<void*>(start), size); });
  return {{static_cast<const uint8_t*>(data), size}, std::move(owner)};
}

UriTarget resolve_uri(const std::filesystem::path& folder, const std::string& uri, const std::string& where) {
  const std::string scheme = uri_scheme(uri);
  if (scheme == "data") return {{}, read_data_uri(uri, where)};
  if (!scheme.empty()) fail(where, "URI is not relative to the file (" + shown_uri(uri) + ")");
  const std::string decoded = percent_decode(uri);
  if (decoded.empty() || decoded.find('\0') != std::string::npos) {
    fail(where, "URI names no file (" + shown_uri(uri) + ")");
  }
  if (decoded[0] == '/' || decoded[0] == '\\') {
    fail(where, "URI is not relative to the file (" + shown_uri(uri) + ")");
  }
  std::string slashes = decoded;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const auto exists = [&](const std::string& name) {
    std::error_code error;
    return std::filesystem::exists(folder / name, error);
  };
  if (!exists(decoded) && exists(uri)) return {folder / uri, {}};
  if (slashes != decoded && !exists(decoded) && exists(slashes)) return {folder / slashes, {}, true};
  return {folder / decoded, {}};
}

}  // namespace chandelier::baker
