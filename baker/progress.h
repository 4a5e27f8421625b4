// SPDX-License-Identifier: Apache-2.0
// Tells someone who waits what the bake is doing, on stderr.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

namespace chandelier::baker {

class Progress {
 public:
  enum class Shown {
    nothing,
    slow_passes,  // a line after each pass that took longer than patience
    all_passes,   // a line after each pass; passes that took next to nothing share one, told when another takes longer
    rewritten,    // one line of a terminal, which is never left behind
  };

  /// Says nothing for the first `patience_s`, since nobody wonders yet.
  explicit Progress(Shown shown, double patience_s = 1, std::FILE* out = stderr);
  explicit Progress(bool terminal) : Progress(terminal ? Shown::rewritten : Shown::nothing) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  /// A pass begins, and ends; Report::run() says so.
  void begin(const std::string& pass) const;
  void end(const std::string& pass, double ms) const;

  /// What the pass does now: "decoding 12 images".
  void next(const std::string& what) const;

  /// How far the pass is. Any thread may say so.
  void advance(std::size_t done, std::size_t total) const;

  /// All is done: takes the rewritten line away, or tells what is untold and the whole time.
  void clear() const;

 private:
  // With mutex_ held.
  void rewrite() const;
  void erase() const;
  void tell(double ended_s, const std::string& passes, double ms) const;
  void tell_quick_passes() const;

  Shown shown_;
  double patience_s_;
  std::FILE* out_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;
  mutable std::string what_;
  mutable std::size_t done_ = 0, total_ = 0;
  mutable bool visible_ = false;
  mutable std::string quick_passes_;  // that ended and are untold
  mutable double quick_ms_ = 0;
  mutable double quick_ended_s_ = 0;
  mutable std::size_t passes_ended_ = 0;
  mutable double pass_began_s_ = 0;
  std::condition_variable_any stopped_;
  std::jthread ticker_;  // at a terminal, so that the seconds run, and where all passes are told
};

}  // namespace chandelier::baker
