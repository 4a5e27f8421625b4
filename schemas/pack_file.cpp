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

#include "file_kind.h"
#include "pack_checks.h"
#include "pack_codec.h"
#include "pack_images.h"
#include "parallel.h"

namespace chandelier::pack {
namespace {

static_assert(std::endian::native == std::endian::little, "packs are little-endian and used in place");
static_assert(sizeof(size_t) == 8, "packs have 64-bit sizes");

/// Below this a thread takes longer to start than to help.
constexpr size_t few_bytes = size_t{4} << 20;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error(path.string() + ": " + what);
}

[[noreturn]] void fail_system(const std::filesystem::path& path, const char* what, int error) {
  fail(path, std::string(what) + " (" + std::generic_category().message(error) + ")");
}

std::string in_parentheses(uint64_t value) {
  return " (" + std::to_string(value) + ")";
}

uint64_t align_up(uint64_t offset) {
  return (offset + section_alignment - 1) / section_alignment * section_alignment;
}

/// Calls `body` for each section, in threads where the file is big enough for that.
template <typename Body>
void for_each_section(uint64_t file_bytes, size_t count, size_t most_threads, const Body& body) {
  if (file_bytes >= few_bytes) return parallel_for(count, most_threads, body);
  for (size_t i = 0; i < count; ++i) body(i);
}

// ---- Writing

struct FileLayout {
  FileHeader header;
  std::vector<SectionEntry> table;
  std::vector<std::span<const std::byte>> sections;
};

/// The file's layout, without checksums. `encoded` has one entry for each of section_infos, or is empty.
FileLayout lay_out(const View& view, const std::vector<Encoded>& encoded) {
  FileLayout layout;
  for (size_t i = 0; i < section_infos.size(); ++i) {
    const std::span<const std::byte> records = section_bytes(view, i);
    if (records.empty()) continue;
    const bool raw = encoded.empty() || encoded[i].codec == Codec::raw;
    const std::span<const std::byte> stored = raw ? records : std::span<const std::byte>(encoded[i].bytes);
    layout.sections.push_back(stored);
    SectionEntry& entry = layout.table.emplace_back();
    entry.kind = static_cast<uint32_t>(section_infos[i].kind);
    entry.codec = raw ? Codec::raw : encoded[i].codec;
    entry.size_bytes = stored.size();
    entry.stride_bytes = section_infos[i].stride_bytes;
    entry.count = records.size() / entry.stride_bytes;
  }
  uint64_t end = sizeof(FileHeader) + layout.table.size() * sizeof(SectionEntry);
  for (SectionEntry& entry : layout.table) {
    entry.offset_bytes = align_up(end);
    end = entry.offset_bytes + entry.size_bytes;
  }
  std::memcpy(layout.header.magic.data(), magic.data(), layout.header.magic.size());
  layout.header.version = schema_version;
  layout.header.section_count = static_cast<uint32_t>(layout.table.size());
  layout.header.schema_hash = schema_hash;
  layout.header.file_bytes = end;
  return layout;
}

/// Writes the sections first, several at a time, then the table with their checksums. Returns the file's size.
uint64_t write_all(TemporaryFile& file, const View& view, Compression compression, size_t most_threads) {
  std::vector<Encoded> encoded;
  EncodedImages images;
  View stored = view;
  if (compression == Compression::smallest) {
    images = encode_images(view, most_threads);
    if (!images.images.empty()) {
      stored.images = images.images;
      stored.image_data = images.image_data;
    }
    encoded = encode_sections(stored, most_threads);
  }
  FileLayout layout = lay_out(stored, encoded);
  const auto write_one = [&](size_t i) {
    const std::span<const std::byte> bytes = layout.sections[i];
    layout.table[i].checksum = XXH3_64bits(bytes.data(), bytes.size());
    file.write(layout.table[i].offset_bytes, bytes.data(), bytes.size());
  };
  for_each_section(layout.header.file_bytes, layout.table.size(), most_threads, write_one);
  const size_t table_bytes = layout.table.size() * sizeof(SectionEntry);
  layout.header.table_checksum = XXH3_64bits(layout.table.data(), table_bytes);
  file.write(0, &layout.header, sizeof(FileHeader));
  file.write(sizeof(FileHeader), layout.table.data(), table_bytes);
  return layout.header.file_bytes;
}

// ---- Reading

/// Maps a file, or copies its present content; MAP_FAILED and errno on failure.
void* map_bytes(int descriptor, size_t size, Hold hold) {
  if (hold == Hold::mapped) return mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  void* const data = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (data == MAP_FAILED) return data;
  size_t done = 0;
  while (done < size) {
    const ssize_t count = read(descriptor, static_cast<std::byte*>(data) + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count > 0) {
      done += static_cast<size_t>(count);
      continue;
    }
    const int error = count < 0 ? errno : ESTALE;  // 0: it became shorter
    munmap(data, size);
    errno = error;
    return MAP_FAILED;
  }
  return data;
}

Mapping map_file(const std::filesystem::path& path, Hold hold) {
  // Non-blocking, so that a FIFO is refused below instead of waited for.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) fail_system(path, "cannot open", errno);
  struct stat status = {};
  const int stat_error = fstat(descriptor, &status) == 0 ? 0 : errno;
  const bool regular = stat_error == 0 && S_ISREG(status.st_mode);
  const size_t size = regular ? static_cast<size_t>(status.st_size) : 0;
  void* data = size > 0 ? map_bytes(descriptor, size, hold) : nullptr;
  const int map_error = data == MAP_FAILED ? errno : 0;
  close(descriptor);
  if (stat_error != 0) fail_system(path, "cannot read", stat_error);
  if (!regular) fail(path, S_ISDIR(status.st_mode) ? "not a file (a folder)" : "not a regular file");
  if (map_error != 0) fail_system(path, hold == Hold::mapped ? "cannot map" : "cannot read", map_error);
  Mapping mapping(data, size);
  if (size < sizeof(FileHeader)) fail(path, "too short for a pack (" + std::to_string(size) + " bytes)");
  return mapping;
}

std::string header_fault(const FileHeader& header, uint64_t size) {
  const std::string versions =
      "(version " + std::to_string(header.version) + ", this program reads " + std::to_string(schema_version) + ")";
  if (header.version < schema_version) return "a pack of an older chandelier-bake: bake it again " + versions;
  if (header.version > schema_version) {
    return "a pack of a newer chandelier-bake: show it with the programs that came with that, or bake it again " +
           versions;
  }
  if (header.schema_hash != schema_hash) {
    return "a pack of another build of chandelier-bake, whose layout is another: bake it again" +
           in_parentheses(header.schema_hash);
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

std::string wrong(const char* field, uint64_t is, uint64_t must_be) {
  return std::string(field) + ": " + std::to_string(is) + " where " + std::to_string(must_be) + " must be";
}

/// Checks an entry whose section must start at `offset`. `info` describes what is expected of its kind.
std::string entry_fault(const SectionEntry& entry, const SectionInfo& info, uint64_t offset, uint64_t file_bytes) {
  if (!is_valid(entry.codec)) {
    return "codec: " + std::to_string(static_cast<uint32_t>(entry.codec)) + " is no Codec";
  }
  if (info.is_always_raw && entry.codec != Codec::raw) {
    return "codec: " + std::string(name_of(entry.codec)) + " where raw must be";
  }
  if (entry.reserved != 0) return wrong("reserved", entry.reserved, 0);
  if (entry.stride_bytes != info.stride_bytes) return wrong("stride_bytes", entry.stride_bytes, info.stride_bytes);
  if (entry.offset_bytes != offset) return wrong("offset_bytes", entry.offset_bytes, offset);
  if (entry.offset_bytes > file_bytes || entry.size_bytes > file_bytes - entry.offset_bytes) {
    return "size_bytes: " + std::to_string(entry.size_bytes) + " from " + std::to_string(offset) +
           " is past the file's end at " + std::to_string(file_bytes);
  }
  if (entry.size_bytes == 0) return wrong("size_bytes", 0, info.stride_bytes);
  if (entry.codec != Codec::raw) {
    return coded_size_fault(entry.codec, entry.stride_bytes, entry.size_bytes, entry.count);
  }
  if (entry.size_bytes % entry.stride_bytes != 0 || entry.size_bytes / entry.stride_bytes != entry.count) {
    return "count: " + std::to_string(entry.count) + " of " + std::to_string(entry.stride_bytes) +
           " bytes are not the size " + std::to_string(entry.size_bytes);
  }
  return {};
}

bool all_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

/// A table entry that passed entry_fault().
struct Found {
  SectionEntry entry;
  size_t info;  // of section_infos
  std::string place;
};

std::string in_section(const Found& found, const std::string& line) {
  return found.place + line + " (section " + std::string(section_infos[found.info].name) + ")";
}

/// Checks the table. Sections must follow each other as the writer lays them out, each at the next multiple of the
/// alignment. So none can overlap, and every byte of the file is covered by a check.
std::string table_fault(std::span<const std::byte> file, std::span<const SectionEntry> table,
                        std::vector<Found>& sections) {
  uint64_t end = sizeof(FileHeader) + table.size_bytes();
  size_t next_info = 0;
  for (size_t i = 0; i < table.size(); ++i) {
    const std::string place = "table[" + std::to_string(i) + "].";
    while (next_info < section_infos.size() && static_cast<uint32_t>(section_infos[next_info].kind) != table[i].kind) {
      ++next_info;
    }
    if (next_info == section_infos.size()) {
      return place + "kind: unknown, or not above the one before" + in_parentheses(table[i].kind);
    }
    const Found& found = sections.emplace_back(Found{table[i], next_info++, place});
    const uint64_t offset = align_up(end);
    if (std::string line = entry_fault(found.entry, section_infos[found.info], offset, file.size()); !line.empty()) {
      return in_section(found, line);
    }
    if (!all_zero(file.subspan(end, offset - end))) return place + "offset_bytes: the bytes before it are not zero";
    end = offset + found.entry.size_bytes;
  }
  if (end != file.size()) return "bytes after the last section" + in_parentheses(file.size() - end);
  return {};
}

std::string checksum_fault(std::span<const std::byte> file, const std::vector<Found>& sections, size_t most_threads) {
  std::vector<std::string> faults(sections.size());
  const auto check_one = [&](size_t i) {
    const SectionEntry& entry = sections[i].entry;
    const uint64_t checksum = XXH3_64bits(file.data() + entry.offset_bytes, entry.size_bytes);
    if (entry.checksum != checksum) faults[i] = in_section(sections[i], wrong("checksum", entry.checksum, checksum));
  };
  for_each_section(file.size(), sections.size(), most_threads, check_one);
  const auto first = std::ranges::find_if(faults, [](const std::string& line) { return !line.empty(); });
  return first == faults.end() ? std::string() : *first;
}

/// Points `view` at the sections' records: in the file, or in `decoded`, which it makes.
std::string place_records(std::span<const std::byte> file, const std::vector<Found>& sections, size_t most_threads,
                          Mapping& decoded, View& view) {
  uint64_t bytes = 0;
  for (const Found& found : sections) {
    if (found.entry.codec != Codec::raw) bytes += align_up(found.entry.count * found.entry.stride_bytes);
  }
  if (bytes > 0) {
    void* data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data == MAP_FAILED) return "not enough memory to decode it (" + std::to_string(bytes) + " bytes)";
    decoded = Mapping(data, bytes);
  }
  std::vector<Coded> coded;
  std::vector<const Found*> coded_found;
  std::span<std::byte> room = decoded.bytes();
  for (const Found& found : sections) {
    const SectionEntry& entry = found.entry;
    const std::span<const std::byte> stored = file.subspan(entry.offset_bytes, entry.size_bytes);
    const std::byte* records = stored.data();
    if (entry.codec != Codec::raw) {
      const uint64_t size = entry.count * entry.stride_bytes;
      coded.push_back({entry.codec, entry.stride_bytes, stored, room.first(size)});
      coded_found.push_back(&found);
      records = room.data();
      room = room.subspan(align_up(size));
    }
    set_section(view, found.info, records, entry.count);
  }
  const std::vector<std::string> faults = decode_all(coded, most_threads);
  for (size_t i = 0; i < coded.size(); ++i) {
    if (faults[i].empty()) continue;
    return in_section(*coded_found[i], "codec: " + std::string(name_of(coded[i].codec)) + ": " + faults[i]);
  }
  return {};
}

}  // namespace

void write(const std::filesystem::path& path, const View& view, Sync sync, Compression compression,
           size_t most_threads) {
  TemporaryFile file(path);
  write_all(file, view, compression, most_threads);
  file.commit(sync);
}

void write(const std::filesystem::path& path, const Contents& contents, Compression compression, size_t most_threads) {
  write(path, view_of(contents), Sync::yes, compression, most_threads);
}

Writer::Writer(const std::filesystem::path& path, const Contents& contents, Compression compression,
               size_t most_threads)
    : file_(path), size_bytes_(write_all(file_, view_of(contents), compression, most_threads)) {
  try {
    syncing_ = std::async(std::launch::async, [this] { file_.sync(); });
  } catch (const std::system_error&) {  // no thread is available: sync() does it
  }
}

void Writer::sync() {
  if (syncing_.valid()) return syncing_.get();
  file_.sync();
}

void Writer::commit() {
  if (syncing_.valid()) sync();
  file_.commit(Sync::yes);
}

Mapping::~Mapping() {
  if (data_) munmap(data_, size_);
}

File::File(const std::filesystem::path& path, size_t most_threads, Hold hold) : file_(map_file(path, hold)) {
  const std::span<const std::byte> bytes = file_.bytes();
  const FileHeader& header = *reinterpret_cast<const FileHeader*>(bytes.data());
  if (std::memcmp(header.magic.data(), magic.data(), magic.size()) != 0) fail(path, no_pack(path, bytes));
  if (std::string line = header_fault(header, bytes.size()); !line.empty()) fail(path, line);
  table_ = {reinterpret_cast<const SectionEntry*>(bytes.data() + sizeof(FileHeader)), header.section_count};
  if (XXH3_64bits(table_.data(), table_.size_bytes()) != header.table_checksum) {
    fail(path, "header.table_checksum: not that of the table" + in_parentheses(header.table_checksum));
  }
  std::vector<Found> sections;
  if (std::string line = table_fault(bytes, table_, sections); !line.empty()) fail(path, line);
  if (std::string line = checksum_fault(bytes, sections, most_threads); !line.empty()) fail(path, line);
  if (std::string line = place_records(bytes, sections, most_threads, decoded_, view_); !line.empty()) fail(path, line);
  if (std::string line = check(view_, most_threads); !line.empty()) fail(path, line);
}

File::File(File&& other) noexcept
    : file_(std::move(other.file_)),
      decoded_(std::move(other.decoded_)),
      view_(std::exchange(other.view_, {})),
      table_(std::exchange(other.table_, {})) {}

File& File::operator=(File&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(decoded_, other.decoded_);
  std::swap(view_, other.view_);
  std::swap(table_, other.table_);
  return *this;
}

std::string_view File::text(const StringRef& ref) const {
  return {reinterpret_cast<const char*>(view_.strings.data()) + ref.offset_bytes, ref.size_bytes};
}

}  // namespace chandelier::pack
