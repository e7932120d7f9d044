// SPDX-License-Identifier: Apache-2.0
/// On which threads components work: on one for all, or on one each. A component's own tasks never
/// run at the same time as each other.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "components/bus/caught.hpp"

namespace strata::runtime {

/// Tasks for one thread, done in the order of posting.
class Mailbox {
 public:
  Mailbox();
  /// Ends the thread after the task under way; later tasks are dropped.
  ~Mailbox();
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  /// Thread safe. What a task throws ends there and is counted: the next one has its turn.
  void post(std::function<void()> task);
  /// Posts, waits until the task is done and rethrows what it threw. Not from the mailbox's thread.
  void call(const std::function<void()>& task);
  /// As the destructor; later posts are ignored.
  void stop();
  [[nodiscard]] const bus::Caught& caught() const { return caught_; }

 private:
  void work();
  bus::Caught caught_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool stopped_ = false;
  std::thread thread_;
};

enum class ExecutorKind { kSingleThreaded, kMultiThreaded };

/// Hands out mailboxes: the same one to all components, or a new one to each.
class Executor {
 public:
  explicit Executor(ExecutorKind kind) : kind_(kind) {}
  [[nodiscard]] std::shared_ptr<Mailbox> mailbox();
  void stop();

 private:
  ExecutorKind kind_;
  std::vector<std::shared_ptr<Mailbox>> mailboxes_;
};

}  // namespace strata::runtime
