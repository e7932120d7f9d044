// SPDX-License-Identifier: Apache-2.0
/// Work on a thread of its own, where what waits gives way to something newer.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace strata::log {

/// One thread at a time may call it.
template <typename T>
class NewestWork {
 public:
  /// work: called on the thread, which begins with what comes first; throws nothing.
  explicit NewestWork(std::function<void(T)> work) : work_(std::move(work)) {}
  /// Works on what waits, unless that was dropped.
  ~NewestWork() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  NewestWork(const NewestWork&) = delete;
  NewestWork& operator=(const NewestWork&) = delete;

  /// change: given what waits, which it fills or replaces. Returns at once.
  void put(const std::function<void(std::optional<T>& waiting)>& change) {
    // First: what waits without a thread would be waited for without end.
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    {
      const std::lock_guard lock(mutex_);
      change(waiting_);
    }
    changed_.notify_all();
  }
  void drop() {
    const std::lock_guard lock(mutex_);
    waiting_.reset();
  }
  [[nodiscard]] bool is_busy() const {
    const std::lock_guard lock(mutex_);
    return works_ || waiting_.has_value();
  }
  /// Until nothing waits and nothing is worked on.
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !waiting_ && !works_; });
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return waiting_ || ends_; });
      if (!waiting_) return;
      T next = std::move(*std::exchange(waiting_, std::nullopt));
      works_ = true;
      lock.unlock();
      work_(std::move(next));
      lock.lock();
      works_ = false;
      changed_.notify_all();
    }
  }

  std::function<void(T)> work_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> waiting_;  // under mutex_, as those below
  bool works_ = false;
  bool ends_ = false;
  std::thread thread_;  // from the first on
};

}  // namespace strata::log
