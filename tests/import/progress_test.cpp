// SPDX-License-Identifier: Apache-2.0
// What someone who waits for a bake is shown, without having to wait.
#include "progress.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
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
  return {bytes.data(), static_cast<std::size_t>(size)};
}

std::string shown_after_passes(Shown shown, double patience_s) {
  const Out out(std::tmpfile());
  {
    const Progress progress(shown, patience_s, out.get());
    progress.begin("import");
    progress.end("import", 1200);
    progress.begin("batches");
    progress.end("batches", 10);
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
  EXPECT_NE(shown.find("s: import took 1.20 s\n"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("batches"), std::string::npos) << shown;
  EXPECT_EQ(shown_after_passes(Shown::slow_passes, never_s), "");
}

TEST(Progress, AllPassesHaveALineEachIfAsked) {
  const std::string shown = shown_after_passes(Shown::all_passes, never_s);
  EXPECT_NE(shown.find("s: import took 1.20 s\n"), std::string::npos) << shown;
  EXPECT_NE(shown.find("s: batches took 0.01 s\n"), std::string::npos) << shown;
}

TEST(Progress, QuietIsQuiet) {
  EXPECT_EQ(shown_after_passes(Shown::nothing, 0), "");
}

}  // namespace
}  // namespace chandelier::baker
