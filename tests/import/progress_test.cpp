// SPDX-License-Identifier: Apache-2.0
// What someone who waits for a bake is shown, without having to wait.
#include "progress.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <regex>
#include <string>
#include <thread>

namespace chandelier::baker {
namespace {

using Shown = Progress::Shown;

constexpr double never_s = 1e9;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using Out = std::unique_ptr<std::FILE, CloseFile>;

/// All that was written and flushed so far.
std::string shown_in(const Out& out) {
  std::array<char, 4096> bytes{};
  const ssize_t size = pread(fileno(out.get()), bytes.data(), bytes.size(), 0);
  return {bytes.data(), static_cast<size_t>(size)};
}

std::string shown_after_passes(Shown shown, double patience_s) {
  const Out out(std::tmpfile());
  {
    const Progress progress(shown, patience_s, out.get());
    const auto pass = [&](const char* name, double ms) {
      progress.begin(name);
      progress.end(name, ms);
    };
    pass("import", 1200);
    pass("materials", 1);
    pass("animation", 2);
    pass("batches", 20);
    pass("sync", 0);
    progress.clear();
  }
  std::fflush(out.get());
  return shown_in(out);
}

TEST(Progress, ATerminalsLineRunsAndIsErasedInTheEnd) {
  const Out out(std::tmpfile());
  {
    const Progress progress(Shown::rewritten, 0, out.get());
    progress.next("decoding images");
    progress.advance(3, 12);
    const auto is_shown = [&] { return shown_in(out).find("s: decoding images 3/12") != std::string::npos; };
    while (!is_shown()) std::this_thread::sleep_for(std::chrono::milliseconds(5));  // the test's time limit ends it
  }
  const std::string shown = shown_in(out);
  EXPECT_EQ(shown.find('\n'), std::string::npos);
  EXPECT_TRUE(shown.starts_with("\r\x1b[Kchandelier-bake: ")) << shown;
  EXPECT_TRUE(shown.ends_with("\r\x1b[K")) << shown;
}

TEST(Progress, ATerminalIsUntouchedWhileNobodyWonders) {
  EXPECT_EQ(shown_after_passes(Shown::rewritten, never_s), "");
}

TEST(Progress, SlowPassesHaveALineEach) {
  const std::string shown = shown_after_passes(Shown::slow_passes, 1);
  EXPECT_NE(shown.find("s:   1.20 s for import\n"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("batches"), std::string::npos) << shown;
  EXPECT_EQ(shown_after_passes(Shown::slow_passes, never_s), "");
}

TEST(Progress, AllPassesAreToldIfAskedAndQuickOnesShareALine) {
  const std::string shown = shown_after_passes(Shown::all_passes, never_s);
  const std::regex expected(
      "chandelier-bake: +[0-9.]+ s:   1\\.20 s for import\n"
      "chandelier-bake: +[0-9.]+ s:   0\\.00 s for materials, animation\n"
      "chandelier-bake: +[0-9.]+ s:   0\\.02 s for batches\n"
      "chandelier-bake: +[0-9.]+ s:   0\\.00 s for sync\n"
      "chandelier-bake: +[0-9.]+ s for all 5 passes\n");
  EXPECT_TRUE(std::regex_match(shown, expected)) << shown;
}

TEST(Progress, QuickPassesAreToldWhileTheNextOneTakesLong) {
  const Out out(std::tmpfile());
  const Progress progress(Shown::all_passes, never_s, out.get());
  progress.begin("materials");
  progress.end("materials", 1);
  progress.begin("batches");
  const auto is_shown = [&] { return shown_in(out).find("s for materials\n") != std::string::npos; };
  while (!is_shown()) std::this_thread::sleep_for(std::chrono::milliseconds(5));  // the test's time limit ends it
}

TEST(Progress, QuietIsQuiet) {
  EXPECT_EQ(shown_after_passes(Shown::nothing, 0), "");
}

}  // namespace
}  // namespace chandelier::baker
