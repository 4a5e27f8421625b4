// SPDX-License-Identifier: Apache-2.0
// Progress: a thread rewrites the line, so that the seconds run while a pass is busy.
#include "progress.h"

#include <fmt/core.h>

#include "error.h"

namespace chandelier::baker {
namespace {

constexpr std::size_t kMostColumns = 60;
constexpr const char* kEraseLine = "\r\x1b[K";

}  // namespace

Progress::Progress(Shown shown, double patience_s, std::FILE* out) : shown_(shown), patience_s_(patience_s), out_(out) {
  if (shown != Shown::rewritten) return;
  ticker_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_for(lock, stop, std::chrono::milliseconds(200), [&] { return stop.stop_requested(); })) {
      if (seconds() > patience_s_ && !what_.empty()) rewrite();
    }
  });
}

Progress::~Progress() {
  if (!ticker_.joinable()) return;
  ticker_.request_stop();
  ticker_.join();
  clear();
}

void Progress::begin(const std::string& pass) const {
  next(pass);
}

void Progress::end(const std::string& pass, double ms) const {
  const bool told = shown_ == Shown::all_passes || (shown_ == Shown::slow_passes && ms > 1000 * patience_s_);
  if (told) fmt::print(out_, "chandelier-bake: {:.2f} s: {} took {:.2f} s\n", seconds(), pass, ms / 1000);
}

void Progress::next(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  what_ = shortened(printable(what), kMostColumns);
  done_ = total_ = 0;
}

void Progress::advance(std::size_t done, std::size_t total) const {
  const std::lock_guard lock(mutex_);
  done_ = done;
  total_ = total;
}

void Progress::clear() const {
  const std::lock_guard lock(mutex_);
  if (visible_) fmt::print(out_, "{}", kEraseLine);
  std::fflush(out_);
  visible_ = false;
  what_.clear();
}

void Progress::rewrite() const {
  const std::string of = total_ > 0 ? fmt::format(" {}/{}", done_, total_) : "";
  fmt::print(out_, "{}chandelier-bake: {:.1f} s: {}{}", kEraseLine, seconds(), what_, of);
  std::fflush(out_);
  visible_ = true;
}

}  // namespace chandelier::baker
