// SPDX-License-Identifier: Apache-2.0
// Progress: a thread rewrites the line, so that the seconds advance during a pass, and prints the passes before it.
#include "progress.h"

#include <fmt/core.h>

#include "error.h"

namespace chandelier::baker {
namespace {

constexpr size_t most_columns = 60;
constexpr const char* erase_line = "\r\x1b[K";
constexpr double quick_ms = 10;  // less shows as 0.00 s
constexpr double long_s = 0.1;   // who watches may learn that another pass is running

}  // namespace

Progress::Progress(Shown shown, double patience_s, std::FILE* out) : shown_(shown), patience_s_(patience_s), out_(out) {
  if (shown != Shown::rewritten && shown != Shown::all_passes) return;
  ticker_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_for(lock, stop, std::chrono::milliseconds(200), [&] { return stop.stop_requested(); })) {
      if (shown_ == Shown::all_passes && seconds() > pass_began_s_ + long_s) print_quick_passes();
      if (shown_ == Shown::rewritten && seconds() > patience_s_ && !what_.empty()) rewrite();
    }
  });
}

Progress::~Progress() {
  if (!ticker_.joinable()) return;
  ticker_.request_stop();
  ticker_.join();
  const std::lock_guard lock(mutex_);
  print_quick_passes();
  erase();
}

void Progress::begin(const std::string& pass) const {
  next(pass);
  const std::lock_guard lock(mutex_);
  pass_began_s_ = seconds();
}

void Progress::end(const std::string& pass, double ms) const {
  const std::lock_guard lock(mutex_);
  if (shown_ == Shown::slow_passes && ms > 1000 * patience_s_) print_line(seconds(), pass, ms);
  if (shown_ != Shown::all_passes) return;
  ++passes_ended_;
  if (ms < quick_ms) {
    quick_passes_ += (quick_passes_.empty() ? "" : ", ") + pass;
    quick_ms_ += ms;
    quick_ended_s_ = seconds();
    return;
  }
  print_quick_passes();
  print_line(seconds(), pass, ms);
}

void Progress::print_line(double ended_s, const std::string& passes, double ms) const {
  fmt::print(out_, "chandelier-bake: {:7.2f} s: {:6.2f} s for {}\n", ended_s, ms / 1000, passes);
  std::fflush(out_);
}

void Progress::print_quick_passes() const {
  if (quick_passes_.empty()) return;
  print_line(quick_ended_s_, quick_passes_, quick_ms_);
  quick_passes_.clear();
  quick_ms_ = 0;
}

void Progress::next(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  what_ = shortened(printable(what), most_columns);
  done_ = total_ = 0;
}

void Progress::advance(size_t done, size_t total) const {
  const std::lock_guard lock(mutex_);
  done_ = done;
  total_ = total;
}

void Progress::clear() const {
  const std::lock_guard lock(mutex_);
  print_quick_passes();
  if (passes_ended_ > 0) fmt::print(out_, "chandelier-bake: {:7.2f} s for all {} passes\n", seconds(), passes_ended_);
  passes_ended_ = 0;
  erase();
}

void Progress::erase() const {
  if (visible_) fmt::print(out_, "{}", erase_line);
  std::fflush(out_);
  visible_ = false;
  what_.clear();
}

void Progress::rewrite() const {
  const std::string of = total_ > 0 ? fmt::format(" {}/{}", done_, total_) : "";
  fmt::print(out_, "{}chandelier-bake: {:.1f} s: {}{}", erase_line, seconds(), what_, of);
  std::fflush(out_);
  visible_ = true;
}

}  // namespace chandelier::baker
