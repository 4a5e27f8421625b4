// SPDX-License-Identifier: Apache-2.0
// An entry NAME is the file NAME.chandelier, whose bake_info.source is NAME, a line feed, and the stage's notes.
#define XXH_INLINE_ALL
#include "cache.h"

#include <elf.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <link.h>
#include <sys/stat.h>
#include <xxhash.h>

#include <algorithm>

#include "threads.h"

namespace chandelier::baker {
namespace {

/// The build ids of the program and of every library that it starts with: equal ones have equal code.
std::string build_ids() {
  std::string out;
  const auto add_notes = [](dl_phdr_info* info, size_t, void* text) {
    if (std::string_view(info->dlpi_name).find("linux-vdso") != std::string_view::npos) return 0;  // the kernel's
    for (int i = 0; i < info->dlpi_phnum; ++i) {
      const ElfW(Phdr)& header = info->dlpi_phdr[i];
      if (header.p_type != PT_NOTE) continue;
      static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(info->dlpi_addr + header.p_vaddr),
                                              header.p_memsz);
    }
    return 0;
  };
  dl_iterate_phdr(add_notes, &out);
  return out;
}

const std::string program_ids = build_ids();  // before main(), so that no module is among them

/// The fault of an entry, or an empty text; fills `notes`.
std::string notes_fault(const pack::File& file, const std::string& name, std::string& notes) {
  const std::string_view source = file.text(file.view().bake_info->source);
  const size_t end = source.find('\n');
  if (source.substr(0, end) != name)
    return "belongs to another entry (" + shortened(std::string(source.substr(0, end)), 60) + ")";
  if (end == std::string_view::npos) return "has no notes";
  notes = source.substr(end + 1);
  return {};
}

XXH3_state_t* hash_of(const std::shared_ptr<void>& state) {
  return static_cast<XXH3_state_t*>(state.get());
}

}  // namespace

CacheKey::CacheKey(std::string stage)
    : stage_(std::move(stage)),
      state_(XXH3_createState(), [](void* state) { XXH3_freeState(static_cast<XXH3_state_t*>(state)); }) {
  XXH3_128bits_reset(hash_of(state_));
  add_text(stage_);
  add_text(program_ids);
  add(pack::schema_hash);
}

void CacheKey::add_bytes(const void* data, size_t size) {
  if (size > 0) XXH3_128bits_update(hash_of(state_), data, size);
}

void CacheKey::add_text(std::string_view text) {
  add(uint64_t{text.size()});
  add_bytes(text.data(), text.size());
}

std::string CacheKey::name() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(hash_of(state_));
  return fmt::format("{}-{:016x}{:016x}", stage_, hash.high64, hash.low64);
}

Cache::Cache(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored)) {
    fail(folder.string(), "cannot make the cache's folder (" + (error ? error.message() : "not a folder") + ")");
  }
  pack::remove_stale_files(folder);
}

std::filesystem::path Cache::path_of(const std::string& name) const {
  return folder_ / (name + ".chandelier");
}

std::unique_ptr<CacheEntry> Cache::load(const std::string& name) {
  if (!is_on()) return nullptr;
  std::unique_ptr<CacheEntry> entry;
  std::string fault;
  if (std::error_code error; std::filesystem::exists(path_of(name), error)) {
    try {
      entry = std::make_unique<CacheEntry>(CacheEntry{pack::File(path_of(name), most_threads()), {}});
      fault = notes_fault(entry->pack, name, entry->notes);
    } catch (const pack::Error& damage) {
      fault = damage.what();
    }
  }
  if (!fault.empty()) {
    reject(name, fault);
    return nullptr;
  }
  // Marked as used now, so that cleaning the folder by age keeps it.
  if (entry) utimensat(AT_FDCWD, path_of(name).c_str(), nullptr, 0);
  const std::lock_guard lock(mutex_);
  loads_[name] = entry != nullptr;
  return entry;
}

void Cache::reject(const std::string& name, const std::string& fault) {
  const std::lock_guard lock(mutex_);
  loads_[name] = false;
  faults_[name] = "cannot be used and is replaced: " + fault;
}

void Cache::store(const std::string& name, const pack::View& sections, const std::string& notes) {
  if (!is_on()) return;
  const std::string source = name + "\n" + notes;
  std::vector<std::byte> strings(sections.strings.begin(), sections.strings.end());
  pack::BakeInfo info = *sections.bake_info;
  info.batch_triangles = std::max(info.batch_triangles, 1u);  // the bake says it later; a pack needs some
  info.source = {fit_u32(strings.size(), "bytes of names"), fit_u32(source.size(), "bytes of names")};
  const auto* text = reinterpret_cast<const std::byte*>(source.data());
  strings.insert(strings.end(), text, text + source.size());
  pack::View view = sections;
  view.bake_info = &info;
  view.strings = strings;
  try {
    // Not synced: after a power failure the checksums find an incomplete file.
    pack::write(path_of(name), view, pack::Sync::no, pack::Compression::off, most_threads());
  } catch (const pack::Error& error) {
    const std::lock_guard lock(mutex_);
    faults_[name] = std::string("cannot be stored: ") + error.what();
  }
}

void Cache::warn(Warnings& warnings) const {
  for (const auto& [name, fault] : faults_) warnings.add(path_of(name).string(), "cache", fault);
}

}  // namespace chandelier::baker
