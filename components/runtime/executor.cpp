// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/executor.hpp"

#include <exception>
#include <future>

namespace strata::runtime {

Mailbox::Mailbox() : thread_([this] { work(); }) {}

Mailbox::~Mailbox() { stop(); }

void Mailbox::post(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void Mailbox::call(const std::function<void()>& task) {
  // Shared: a mailbox that stops drops the task, and with it the promise, which ends the wait.
  auto done = std::make_shared<std::promise<void>>();
  std::future<void> result = done->get_future();
  post([done = std::move(done), &task] {
    try {
      task();
      done->set_value();
    } catch (...) {
      done->set_exception(std::current_exception());
    }
  });
  result.get();
}

void Mailbox::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    tasks_.clear();
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void Mailbox::work() {
  for (;;) {
    std::function<void()> task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopped_ || !tasks_.empty(); });
      if (stopped_) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    (void)caught_.run(task);
  }
}

std::shared_ptr<Mailbox> Executor::mailbox() {
  if (mailboxes_.empty() || kind_ == ExecutorKind::kMultiThreaded) {
    mailboxes_.push_back(std::make_shared<Mailbox>());
  }
  return mailboxes_.back();
}

void Executor::stop() {
  for (const auto& mailbox : mailboxes_) mailbox->stop();
}

}  // namespace strata::runtime
