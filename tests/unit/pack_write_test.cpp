// SPDX-License-Identifier: Apache-2.0
// A pack is written whole or not at all.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

using Names = std::vector<std::string>;

std::string write_error(const std::filesystem::path& path, const Contents& contents) {
  try {
    write(path, contents);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

/// No file of this process may grow beyond `bytes`: writing fails as it does on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int) = nullptr;
};

TEST(PackWrite, FailingHalfWayLeavesTheOldPackAndNothingElse) {
  const Folder folder;
  Contents contents = sample();
  write(folder / "a.pack", contents);
  const std::vector<char> before = read_file(folder / "a.pack");
  contents.lights.clear();
  for (const rlim_t limit : {0, 1, 40, 700, 1000, 2000}) {
    std::string error;
    {
      const FileSizeLimit full(limit);
      error = write_error(folder / "a.pack", contents);
    }
    EXPECT_NE(error.find("a.pack: cannot write (File too large)"), std::string::npos) << error;
  }
  EXPECT_EQ(folder.names(), Names{"a.pack"});
  EXPECT_EQ(read_file(folder / "a.pack"), before);
  write(folder / "a.pack", contents);
  EXPECT_NE(read_file(folder / "a.pack"), before);
}

TEST(PackWrite, NoSuchFolder) {
  const Folder folder;
  const std::string error = write_error(folder / "none/a.pack", sample());
  EXPECT_NE(error.find("none/a.pack: cannot create a file in its folder (No such file or directory)"),
            std::string::npos)
      << error;
  EXPECT_EQ(folder.names(), Names{});
}

TEST(PackWrite, AFileIsNoFolder) {
  const Folder folder;
  write(folder / "a.pack", sample());
  EXPECT_NE(write_error(folder / "a.pack/b.pack", sample()), "");
  EXPECT_EQ(open_error(folder / "a.pack"), "");
}

TEST(PackWrite, FoldersAndDevicesAreNotReplaced) {
  const Folder folder;
  std::filesystem::create_directory(folder / "b");
  EXPECT_NE(write_error(folder / "b", sample()).find("exists and is not a regular file"), std::string::npos);
  EXPECT_NE(write_error(folder / "", sample()), "");
  ASSERT_EQ(mkfifo((folder / "c").c_str(), 0600), 0);
  EXPECT_NE(write_error(folder / "c", sample()).find("exists and is not a regular file"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "c"));
}

TEST(PackWrite, PermissionsFollowTheUmask) {
  const Folder folder;
  const mode_t before = umask(027);
  write(folder / "a.pack", sample());
  umask(before);
  struct stat status = {};
  ASSERT_EQ(stat((folder / "a.pack").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(PackWrite, LongNamesWork) {
  const Folder folder;
  const std::string name(255, 'n');
  write(folder / name, sample());
  EXPECT_EQ(folder.names(), Names{name});
}

}  // namespace
}  // namespace chandelier::pack::test
