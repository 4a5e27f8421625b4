// SPDX-License-Identifier: Apache-2.0
// Writes a pack atomically; opens one by mapping it and checking everything before anything is used.
#define XXH_INLINE_ALL
#include "pack_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "pack_checks.h"

namespace chandelier::pack {
namespace {

static_assert(std::endian::native == std::endian::little, "packs are little-endian and used in place");
static_assert(sizeof(std::size_t) == 8, "packs have 64-bit sizes");

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error(path.string() + ": " + what);
}

[[noreturn]] void fail_system(const std::filesystem::path& path, const char* what, int error) {
  fail(path, std::string(what) + " (" + std::generic_category().message(error) + ")");
}

std::string in_parentheses(std::uint64_t value) {
  return " (" + std::to_string(value) + ")";
}

std::uint64_t align_up(std::uint64_t offset) {
  return (offset + section_alignment - 1) / section_alignment * section_alignment;
}

// ---- Writing

void write_zeros(TemporaryFile& file, std::uint64_t size) {
  static constexpr std::byte zeros[section_alignment] = {};
  file.write(zeros, size);
}

struct Layout {
  FileHeader header;
  std::vector<SectionEntry> table;
  std::vector<std::span<const std::byte>> sections;
};

Layout lay_out(const View& view) {
  Layout layout;
  for (std::size_t i = 0; i < section_infos.size(); ++i) {
    const std::span<const std::byte> bytes = section_bytes(view, i);
    if (bytes.empty()) continue;
    layout.sections.push_back(bytes);
    SectionEntry& entry = layout.table.emplace_back();
    entry.kind = static_cast<std::uint32_t>(section_infos[i].kind);
    entry.size_bytes = bytes.size();
    entry.stride_bytes = section_infos[i].stride_bytes;
    entry.count = bytes.size() / entry.stride_bytes;
    entry.checksum = XXH3_64bits(bytes.data(), bytes.size());
  }
  std::uint64_t end = sizeof(FileHeader) + layout.table.size() * sizeof(SectionEntry);
  for (SectionEntry& entry : layout.table) {
    entry.offset_bytes = align_up(end);
    end = entry.offset_bytes + entry.size_bytes;
  }
  std::memcpy(layout.header.magic.data(), magic.data(), layout.header.magic.size());
  layout.header.version = schema_version;
  layout.header.section_count = static_cast<std::uint32_t>(layout.table.size());
  layout.header.schema_hash = schema_hash;
  layout.header.file_bytes = end;
  layout.header.table_checksum = XXH3_64bits(layout.table.data(), layout.table.size() * sizeof(SectionEntry));
  return layout;
}

void write_layout(TemporaryFile& file, const Layout& layout) {
  file.write(&layout.header, sizeof(FileHeader));
  file.write(layout.table.data(), layout.table.size() * sizeof(SectionEntry));
  std::uint64_t end = sizeof(FileHeader) + layout.table.size() * sizeof(SectionEntry);
  for (std::size_t i = 0; i < layout.table.size(); ++i) {
    write_zeros(file, layout.table[i].offset_bytes - end);
    file.write(layout.sections[i].data(), layout.sections[i].size());
    end = layout.table[i].offset_bytes + layout.table[i].size_bytes;
  }
}

// ---- Reading

/// Unmaps unless it is released into a File.
struct Mapping {
  void* data = nullptr;
  std::size_t size = 0;

  explicit Mapping(const std::filesystem::path& path);
  ~Mapping() {
    if (data) munmap(data, size);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
};

Mapping::Mapping(const std::filesystem::path& path) {
  // Non-blocking, so that a FIFO is refused below instead of waited for.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) fail_system(path, "cannot open", errno);
  struct stat status = {};
  const int stat_error = fstat(descriptor, &status) == 0 ? 0 : errno;
  const bool regular = stat_error == 0 && S_ISREG(status.st_mode);
  int map_error = 0;
  if (regular && status.st_size > 0) {
    size = static_cast<std::size_t>(status.st_size);
    data = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    map_error = data == MAP_FAILED ? errno : 0;
    if (map_error != 0) data = nullptr;
  }
  close(descriptor);
  if (stat_error != 0) fail_system(path, "cannot read", stat_error);
  if (!regular) fail(path, S_ISDIR(status.st_mode) ? "not a file (a folder)" : "not a regular file");
  if (map_error != 0) fail_system(path, "cannot map", map_error);
  if (size < sizeof(FileHeader)) fail(path, "too short for a pack (" + std::to_string(size) + " bytes)");
}

std::string header_fault(const FileHeader& header, std::uint64_t size) {
  if (std::memcmp(header.magic.data(), magic.data(), magic.size()) != 0) return "not a Chandelier pack (wrong magic)";
  if (header.version != schema_version) {
    return "a pack of another version, bake it again" + in_parentheses(header.version);
  }
  if (header.schema_hash != schema_hash) {
    return "a pack of another layout, bake it again" + in_parentheses(header.schema_hash);
  }
  if (header.file_bytes != size) {
    return "header.file_bytes: " + std::to_string(header.file_bytes) + " where the file has " + std::to_string(size);
  }
  if (header.section_count > max_sections) {
    return "header.section_count: " + std::to_string(header.section_count) + " is above " +
           std::to_string(max_sections);
  }
  if (header.section_count > (size - sizeof(FileHeader)) / sizeof(SectionEntry)) {
    return "header.section_count: " + std::to_string(header.section_count) + " do not fit the file";
  }
  return {};
}

/// Checks an entry whose section must start at `offset`, and its bytes. `info` is what its kind should be like.
std::string entry_fault(const SectionEntry& entry, const SectionInfo& info, std::uint64_t offset,
                        std::span<const std::byte> file) {
  const auto wrong = [](const char* field, std::uint64_t is, std::uint64_t must_be) {
    return std::string(field) + ": " + std::to_string(is) + " where " + std::to_string(must_be) + " must be";
  };
  if (!is_valid(entry.codec))
    return "codec: " + std::to_string(static_cast<std::uint32_t>(entry.codec)) + " is no Codec";
  if (entry.reserved != 0) return wrong("reserved", entry.reserved, 0);
  if (entry.stride_bytes != info.stride_bytes) return wrong("stride_bytes", entry.stride_bytes, info.stride_bytes);
  if (entry.offset_bytes != offset) return wrong("offset_bytes", entry.offset_bytes, offset);
  if (entry.offset_bytes > file.size() || entry.size_bytes > file.size() - entry.offset_bytes) {
    return "size_bytes: " + std::to_string(entry.size_bytes) + " from " + std::to_string(offset) +
           " is past the file's end at " + std::to_string(file.size());
  }
  if (entry.size_bytes == 0) return wrong("size_bytes", 0, info.stride_bytes);
  if (entry.size_bytes % entry.stride_bytes != 0 || entry.size_bytes / entry.stride_bytes != entry.count) {
    return "count: " + std::to_string(entry.count) + " of " + std::to_string(entry.stride_bytes) +
           " bytes are not the size " + std::to_string(entry.size_bytes);
  }
  const std::uint64_t checksum = XXH3_64bits(file.data() + entry.offset_bytes, entry.size_bytes);
  if (entry.checksum != checksum) return wrong("checksum", entry.checksum, checksum);
  return {};
}

bool all_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

/// Checks table and sections, and points `view` at them. Sections follow each other as the writer lays them out, each
/// at the next multiple of the alignment, so none can overlap and every byte of the file is one that something checks.
std::string table_fault(std::span<const std::byte> file, const FileHeader& header, View& view) {
  const std::byte* table_data = file.data() + sizeof(FileHeader);
  const std::size_t table_bytes = header.section_count * sizeof(SectionEntry);
  if (XXH3_64bits(table_data, table_bytes) != header.table_checksum) {
    return "header.table_checksum: not that of the table" + in_parentheses(header.table_checksum);
  }
  const std::span table(reinterpret_cast<const SectionEntry*>(table_data), header.section_count);
  std::uint64_t end = sizeof(FileHeader) + table_bytes;
  std::size_t next_info = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const SectionEntry& entry = table[i];
    const std::string place = "table[" + std::to_string(i) + "].";
    while (next_info < section_infos.size() &&
           static_cast<std::uint32_t>(section_infos[next_info].kind) != entry.kind) {
      ++next_info;
    }
    if (next_info == section_infos.size()) {
      return place + "kind: unknown, or not above the one before" + in_parentheses(entry.kind);
    }
    const std::uint64_t offset = align_up(end);
    if (std::string line = entry_fault(entry, section_infos[next_info], offset, file); !line.empty()) {
      return place + line + " (section " + std::string(section_infos[next_info].name) + ")";
    }
    if (!all_zero(file.subspan(end, offset - end))) return place + "offset_bytes: the bytes before it are not zero";
    set_section(view, next_info, file.data() + offset, entry.count);
    end = offset + entry.size_bytes;
    ++next_info;
  }
  if (end != file.size()) return "bytes after the last section" + in_parentheses(file.size() - end);
  return {};
}

}  // namespace

void write(const std::filesystem::path& path, const View& view, Sync sync) {
  TemporaryFile file(path);
  write_layout(file, lay_out(view));
  file.commit(sync);
}

void write(const std::filesystem::path& path, const Contents& contents) {
  write(path, view_of(contents), Sync::yes);
}

File::File(const std::filesystem::path& path) {
  Mapping mapping(path);
  const std::span bytes(static_cast<const std::byte*>(mapping.data), mapping.size);
  const FileHeader& header = *reinterpret_cast<const FileHeader*>(mapping.data);
  if (std::string line = header_fault(header, mapping.size); !line.empty()) fail(path, line);
  if (std::string line = table_fault(bytes, header, view_); !line.empty()) fail(path, line);
  if (std::string line = check(view_); !line.empty()) fail(path, line);
  data_ = std::exchange(mapping.data, nullptr);
  size_ = mapping.size;
}

File::~File() {
  if (data_) munmap(data_, size_);
}

File::File(File&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      view_(std::exchange(other.view_, {})) {}

File& File::operator=(File&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(view_, other.view_);
  return *this;
}

std::string_view File::text(const StringRef& ref) const {
  return {reinterpret_cast<const char*>(view_.strings.data()) + ref.offset_bytes, ref.size_bytes};
}

}  // namespace chandelier::pack
