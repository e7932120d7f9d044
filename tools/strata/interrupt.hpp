// SPDX-License-Identifier: Apache-2.0
/// Ctrl-C and SIGTERM, turned into a flag that long work looks at.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace strata::tools {

/// Takes SIGINT and SIGTERM for the whole process: create one, first thing in main, before any
/// other thread. When a signal comes and the program has not ended `grace_s` later, `on_overdue` is
/// called (to remove half-written output) and the process ends with exit code 1, so that a piece of
/// work that forgot to look at the flag cannot keep the user waiting.
class Interrupt {
 public:
  explicit Interrupt(double grace_s = 1.6);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool requested() const { return requested_.load(std::memory_order_relaxed); }
  /// What to do before the process is ended the hard way.
  void set_on_overdue(std::function<void()> on_overdue);
  /// For verbs whose clean end may take longer than the grace time (`run`, `record`).
  void disable_deadline() { deadline_.store(false); }
  /// Returns after the time, or at once when an interrupt is or gets requested; says whether it is.
  bool wait_for(double seconds);

 private:
  void watch();

  double grace_s_;
  std::atomic<bool> requested_{false};
  std::atomic<bool> deadline_{true};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool finished_ = false;
  std::function<void()> on_overdue_;
  std::thread watcher_;
};

}  // namespace strata::tools
