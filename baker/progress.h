// SPDX-License-Identifier: Apache-2.0
// Progress of the bake on stderr.
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
    all_passes,   // a line after each pass; very short passes share one line, printed before the next longer pass
    rewritten,    // one line of a terminal, erased at the end
  };

  /// Prints nothing for the first `patience_s` seconds.
  explicit Progress(Shown shown, double patience_s = 1, std::FILE* out = stderr);
  explicit Progress(bool terminal) : Progress(terminal ? Shown::rewritten : Shown::nothing) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  /// A pass begins or ends; called by Report::run().
  void begin(const std::string& pass) const;
  void end(const std::string& pass, double ms) const;

  /// Sets what the pass is doing: "decoding 12 images".
  void next(const std::string& what) const;

  /// Sets how far the pass is. Any thread may call it.
  void advance(size_t done, size_t total) const;

  /// The bake is done: erases the rewritten line, or prints the remaining passes and the total time.
  void clear() const;

 private:
  // With mutex_ held.
  void rewrite() const;
  void erase() const;
  void print_line(double ended_s, const std::string& passes, double ms) const;
  void print_quick_passes() const;

  Shown shown_;
  double patience_s_;
  std::FILE* out_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;
  mutable std::string what_;
  mutable size_t done_ = 0, total_ = 0;
  mutable bool visible_ = false;
  mutable std::string quick_passes_;  // that have ended but are not printed yet
  mutable double quick_ms_ = 0;
  mutable double quick_ended_s_ = 0;
  mutable size_t passes_ended_ = 0;
  mutable double pass_began_s_ = 0;
  std::condition_variable_any stopped_;
  std::jthread ticker_;  // updates the seconds at a terminal, and is used with all_passes
};

}  // namespace chandelier::baker
