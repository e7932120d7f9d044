// SPDX-License-Identifier: Apache-2.0
/// The newest status of every component, as metrics.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "strata_idl/diagnostic_msgs.h"

#include "components/live_view/metric_text.hpp"

namespace strata::live_view {

/// Thread safe: who brings statuses never waits for who reads them, which holds the lock only for
/// as long as it takes to count up a few references.
class StatusBoard {
 public:
  using Clock = std::chrono::steady_clock;
  /// Older ones say only that their component is silent, and much older ones nothing.
  static constexpr std::chrono::seconds kSilent{15};
  static constexpr std::chrono::hours kForgotten{1};
  /// More components are left out, and so are more entries of one status.
  static constexpr std::size_t kMaxComponents = 256;
  static constexpr std::size_t kMaxEntries = 1000;

  /// Takes the statuses of Strata's components ("robot1/localizer: health"); others are left out.
  void take(const diagnostic_msgs::msg::DiagnosticArray& array, Clock::time_point now);
  /// Adds what they say; what is no number of its kind is left out. O(entries).
  void write(MetricText& metrics, Clock::time_point now) const;

 private:
  using Status = diagnostic_msgs::msg::DiagnosticStatus;
  struct Heard {
    std::shared_ptr<const Status> status;
    Clock::time_point at;
  };
  mutable std::mutex mutex_;
  std::map<std::string, Heard> components_;  ///< by full name, "/robot1/localizer"
};

/// Adds what the system says of this process; what it does not say is left out.
void write_process(MetricText& metrics);

}  // namespace strata::live_view
