// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/interrupt.hpp"

#include <chrono>
#include <csignal>
#include <ctime>
#include <utility>

#include <pthread.h>
#include <unistd.h>

namespace strata::tools {
namespace {

/// Ends the watcher; never sent from outside in practice.
constexpr int kWakeSignal = SIGUSR2;
/// Signals that come closer together than this are one wish to end.
constexpr auto kSameWish = std::chrono::seconds(1);
/// The grace time may grow while it runs, so that it is looked at again and again.
constexpr timespec kLookAgain = {0, 50'000'000};

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  // The terminal is gone. Who ignores it from the start (nohup) is to stay.
  if (!is_ignored(SIGHUP)) sigaddset(&set, SIGHUP);
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

void Interrupt::set_on_overdue(std::function<void(Overdue)> on_overdue) {
  const std::lock_guard lock(mutex_);
  on_overdue_ = std::move(on_overdue);
}

bool Interrupt::wait_for(double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return requested(); });
  return requested();
}

void Interrupt::take_signal(int signal, Clock::time_point now) {
  if (!first_) {
    first_ = now;
    first_signal_ = signal;
    requested_.store(true);
    changed_.notify_all();
  } else if (!second_ && may_be_hurried_.load() && signal == first_signal_ &&
             now - *first_ >= kSameWish) {
    second_ = now;
    hurried_.store(true);
  }
}

std::optional<Interrupt::Overdue> Interrupt::overdue(Clock::time_point now) const {
  if (second_ && now - *second_ >= std::chrono::duration<double>(hurried_grace_s_.load())) {
    return Overdue::kHurried;
  }
  if (first_ && now - *first_ >= std::chrono::duration<double>(grace_s_.load())) {
    return writes_at_the_end_.load() ? Overdue::kUnwritten : Overdue::kGraceIsOver;
  }
  return std::nullopt;
}

void Interrupt::watch() {
  const sigset_t set = watched_signals();
  for (;;) {
    const int signal = sigtimedwait(&set, nullptr, first_ ? &kLookAgain : nullptr);
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    const auto now = Clock::now();
    if (signal > 0 && signal != kWakeSignal) take_signal(signal, now);
    if (const auto why = overdue(now)) {
      if (on_overdue_) on_overdue_(*why);
      _exit(1);
    }
  }
}

}  // namespace strata::tools
