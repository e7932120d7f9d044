// SPDX-License-Identifier: Apache-2.0
/// When the processes of a composition are started again.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "components/runtime/composition.hpp"

namespace strata::tools {

class Restarts {
 public:
  using Clock = std::chrono::steady_clock;

  /// Of a process that ended at `now`: the delay before its next start, from restart_delay_s and
  /// doubled with each end in a row, to a minute at most; nothing when its policy is not to.
  std::optional<std::chrono::duration<double>> plan(const runtime::ProcessEntry& process,
                                                    bool failed, Clock::time_point now);
  void started(const std::string& name, Clock::time_point now);
  /// Planned, not started since, and the delay is over.
  [[nodiscard]] bool is_due(const std::string& name, Clock::time_point now) const;

 private:
  struct State {
    Clock::time_point started;
    std::optional<Clock::time_point> due;
    int ends = 0;  ///< in a row
  };
  std::map<std::string, State> states_;
};

}  // namespace strata::tools
