// SPDX-License-Identifier: Apache-2.0
// Temporary files are `.chandelier-PID-N.tmp`, locked with flock() as long as their writer lives.
#include "temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "pack_file.h"

namespace chandelier::pack {
namespace {

constexpr std::string_view prefix = ".chandelier-", suffix = ".tmp";

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw Error(path.string() + ": " + what);
}

[[noreturn]] void fail_system(const std::filesystem::path& path, const char* what, int error) {
  throw Error(path.string() + ": " + what + " (" + std::generic_category().message(error) + ")");
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// Whether an open file still has a name: the sweep may have taken it between its creation and its lock.
bool has_name(int descriptor) {
  struct stat status = {};
  return fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

/// Makes the rename durable. The file is complete and in place, so it is not an error if the file system cannot do
/// this.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

TemporaryFile::TemporaryFile(const std::filesystem::path& path) : path_(path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!path.has_filename()) fail(path, "not a file name");
  if (exists(status) && !is_regular_file(status)) fail(path, "exists and is not a regular file");
  while (!create(folder_of(path))) {
  }
}

// Not mkstemp(): the file should get the permissions that the user's umask gives any new file.
bool TemporaryFile::create(const std::filesystem::path& folder) {
  static std::atomic<unsigned> counter = 0;
  const std::string id = std::to_string(getpid()) + "-" + std::to_string(counter++);
  const std::filesystem::path candidate = folder / (std::string(prefix) + id + std::string(suffix));
  descriptor_ = open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0 && errno == EEXIST) return false;
  if (descriptor_ < 0) fail_system(path_, "cannot create a file in its folder", errno);
  temporary_ = candidate;
  // On a file system without locks nothing is deleted either, since that needs a lock.
  if (flock(descriptor_, LOCK_EX) != 0 || has_name(descriptor_)) return true;
  close(std::exchange(descriptor_, -1));
  return false;
}

TemporaryFile::~TemporaryFile() {
  if (descriptor_ < 0) return;
  unlink(temporary_.c_str());  // before the lock is released, so that nobody else takes the name in between
  close(descriptor_);
}

void TemporaryFile::write(uint64_t offset, const void* data, size_t size) {
  const char* at = static_cast<const char*>(data);
  auto place = static_cast<off_t>(offset);
  while (size > 0) {
    const ssize_t written = pwrite(descriptor_, at, size, place);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_system(path_, "cannot write", errno);
    at += written;
    place += written;
    size -= static_cast<size_t>(written);
  }
}

void TemporaryFile::sync() {
  if (fsync(descriptor_) != 0) fail_system(path_, "cannot sync", errno);
  synced_ = true;
}

void TemporaryFile::commit(Sync sync) {
  if (sync == Sync::yes && !synced_) this->sync();
  if (rename(temporary_.c_str(), path_.c_str()) != 0) fail_system(path_, "cannot replace", errno);
  if (close(std::exchange(descriptor_, -1)) != 0) fail_system(path_, "cannot close", errno);
  if (sync == Sync::yes) sync_folder(folder_of(path_));
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  TemporaryFile file(path);
  file.write(0, text.data(), text.size());
  file.commit(Sync::yes);
}

void remove_stale_files(const std::filesystem::path& folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    const int descriptor = open(it->path().c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) unlink(it->path().c_str());
    close(descriptor);
  }
}

}  // namespace chandelier::pack
