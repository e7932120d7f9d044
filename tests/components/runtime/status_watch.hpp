// SPDX-License-Identifier: Apache-2.0
/// Waits for what a component says on /diagnostics.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "components/bus/endpoint.hpp"
#include "components/runtime/diagnostics.hpp"
#include "components/runtime/host.hpp"

namespace strata::test {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;

inline std::string value_of(const DiagnosticStatus& status, const std::string& key) {
  return std::string(runtime::value_of(status, key));
}

/// Ticks the host, as `run` does, until a status satisfies the condition.
class StatusWatch {
 public:
  explicit StatusWatch(const std::shared_ptr<bus::Participant>& participant)
      : reader_(participant, "/diagnostics", bus::qos_profile("default"),
                [this](const DiagnosticArray& array) {
                  const std::lock_guard lock(mutex_);
                  last_ = array;
                  changed_.notify_all();
                }) {}
  [[nodiscard]] DiagnosticStatus wait_for(
      runtime::Host& host, const std::function<bool(const DiagnosticStatus&)>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    std::unique_lock lock(mutex_);
    while (std::chrono::steady_clock::now() < deadline) {
      if (!last_.status().empty() && condition(last_.status()[0])) return last_.status()[0];
      lock.unlock();
      host.tick();
      lock.lock();
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return {};
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  DiagnosticArray last_;
  bus::Reader<DiagnosticArray> reader_;
};

}  // namespace strata::test
