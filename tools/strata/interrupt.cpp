// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/interrupt.hpp"

#include <chrono>
#include <csignal>
#include <utility>

#include <pthread.h>
#include <unistd.h>

namespace strata::tools {
namespace {

/// Ends the watcher; never sent from outside in practice.
constexpr int kWakeSignal = SIGUSR2;

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, kWakeSignal);
  return set;
}

}  // namespace

Interrupt::Interrupt(double grace_s) : grace_s_(grace_s) {
  // Blocked here, threads made later inherit it: only the watcher ever receives them.
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  watcher_ = std::thread([this] { watch(); });
}

Interrupt::~Interrupt() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
  pthread_kill(watcher_.native_handle(), kWakeSignal);
  watcher_.join();
}

void Interrupt::set_on_overdue(std::function<void()> on_overdue) {
  const std::lock_guard lock(mutex_);
  on_overdue_ = std::move(on_overdue);
}

bool Interrupt::wait_for(double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return requested(); });
  return requested();
}

void Interrupt::watch() {
  const sigset_t set = watched_signals();
  int signal = 0;
  while (sigwait(&set, &signal) == 0) {
    std::unique_lock lock(mutex_);
    if (finished_) return;
    if (signal == kWakeSignal) continue;
    requested_.store(true);
    changed_.notify_all();
    if (!deadline_.load()) continue;
    changed_.wait_for(lock, std::chrono::duration<double>(grace_s_), [this] { return finished_; });
    if (finished_) return;
    if (on_overdue_) on_overdue_();
    _exit(1);
  }
}

}  // namespace strata::tools
