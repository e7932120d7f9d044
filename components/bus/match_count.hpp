// SPDX-License-Identifier: Apache-2.0
/// Who is matched with an endpoint; for the bus's own .cpp files only.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <utility>

#include "components/bus/domain_view.hpp"

namespace strata::bus {

/// How many counterparts are matched, for those who wait.
class MatchCount {
 public:
  explicit MatchCount(std::function<void()> on_match) : on_match_(std::move(on_match)) {}
  /// The last call of `set` has left everything: the middleware's own locks, behind which it was
  /// made, are not ours to rely on.
  ~MatchCount() { const std::lock_guard lock(mutex_); }
  MatchCount(const MatchCount&) = delete;
  MatchCount& operator=(const MatchCount&) = delete;
  /// other: the counterpart that came or went.
  void set(int count, const Guid& other, bool came) {
    std::function<void()> notify;
    {
      const std::lock_guard lock(mutex_);
      count_ = count;
      if (came) {
        others_.insert(other);
      } else {
        others_.erase(other);
      }
      notify = on_match_;
      changed_.notify_all();  // locked, for the destructor
    }
    if (notify) notify();
  }
  void stop_notifying() {
    const std::lock_guard lock(mutex_);
    on_match_ = nullptr;
  }
  [[nodiscard]] int get() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  [[nodiscard]] bool has(const Guid& participant) const {
    const std::lock_guard lock(mutex_);
    return std::any_of(others_.begin(), others_.end(),
                       [&](const Guid& other) { return same_participant(other, participant); });
  }
  [[nodiscard]] bool wait(int least, std::chrono::milliseconds timeout) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, timeout, [&] { return count_ >= least; });
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  int count_ = 0;
  std::set<Guid> others_;
  std::function<void()> on_match_;
};

}  // namespace strata::bus
