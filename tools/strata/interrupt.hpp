// SPDX-License-Identifier: Apache-2.0
/// Ctrl-C, SIGTERM and SIGHUP, turned into a flag that long work looks at.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace strata::tools {

/// Takes SIGINT, SIGTERM and, unless it is ignored, SIGHUP for the whole process: create one, first
/// thing in main, before any other thread. When a signal comes and the program has not ended
/// `grace_s` later, `on_overdue` is called (to remove half-written output) and the process ends
/// with exit code 1, so that a piece of work that forgot to look at the flag cannot keep the user
/// waiting. The same signal again cuts the grace time short, unless it belongs to the first:
/// `timeout` and terminals send two at once. Another one does not: `ros2 launch` sends SIGINT and,
/// 5 s later, SIGTERM.
class Interrupt {
 public:
  enum class Overdue {
    kGraceIsOver,
    kUnwritten,  ///< as before, of work that had asked for time to write
    kHurried
  };

  explicit Interrupt(double grace_s = 1.6);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool requested() const { return requested_.load(std::memory_order_relaxed); }
  /// The signal has come again: what still runs has another second, or what set_grace says.
  [[nodiscard]] bool is_hurried() const { return hurried_.load(std::memory_order_relaxed); }
  /// What to do before the process is ended the hard way.
  void set_on_overdue(std::function<void(Overdue)> on_overdue);
  /// For what has to be written at the end and may take longer (`run`, `record`). Holds for a
  /// signal that has come already as well.
  void set_grace(double grace_s, double hurried_grace_s = 1.0) {
    grace_s_.store(grace_s);
    hurried_grace_s_.store(hurried_grace_s);
    writes_at_the_end_.store(true);
  }
  /// For a process whose parent decides when it has waited for long enough.
  void ignore_further_signals() { may_be_hurried_.store(false); }
  /// Returns after the time, or at once when an interrupt is or gets requested; says whether it is.
  bool wait_for(double seconds);

 private:
  using Clock = std::chrono::steady_clock;
  void watch();
  void take_signal(int signal, Clock::time_point now);
  [[nodiscard]] std::optional<Overdue> overdue(Clock::time_point now) const;

  std::atomic<double> grace_s_;
  std::atomic<double> hurried_grace_s_{1.0};
  std::atomic<bool> writes_at_the_end_{false};
  std::atomic<bool> requested_{false};
  std::atomic<bool> hurried_{false};
  std::atomic<bool> may_be_hurried_{true};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool finished_ = false;
  std::function<void(Overdue)> on_overdue_;
  std::optional<Clock::time_point> first_;   ///< when it was requested; the watcher's own
  int first_signal_ = 0;                     ///< likewise
  std::optional<Clock::time_point> second_;  ///< when it was hurried; likewise
  std::thread watcher_;
};

}  // namespace strata::tools
