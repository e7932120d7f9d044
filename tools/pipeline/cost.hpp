// SPDX-License-Identifier: Apache-2.0
/// What a job cost: wall clock, processor time, memory; child processes that have ended count.
#pragma once

#include <chrono>

namespace strata::pipeline {

struct Cost {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  double peak_rss_mb = 0.0;  ///< of the largest process so far
};

/// Measures from its construction on.
class CostMeter {
 public:
  CostMeter();
  [[nodiscard]] Cost read() const;

 private:
  std::chrono::steady_clock::time_point wall_begin_;
  double cpu_begin_s_;
};

}  // namespace strata::pipeline
