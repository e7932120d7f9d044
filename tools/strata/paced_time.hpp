// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace strata::tools {

/// When the scans of a log are due that is shown at a rate. Silences, as nights are, are cut short:
/// nobody waits for the morning.
class PacedTime {
 public:
  static constexpr double kMaxSilence_s = 5.0;
  explicit PacedTime(double rate) : rate_(rate) {}

  /// In seconds from the first scan, by the clock on the wall. log_s: of the scan, in the order of
  /// the log.
  [[nodiscard]] double due_s(double log_s) {
    shown_s_ += std::clamp(log_s - last_s_, 0.0, kMaxSilence_s);
    last_s_ = log_s;
    return shown_s_ / rate_;
  }

 private:
  double rate_;
  double last_s_ = 0.0;
  double shown_s_ = 0.0;
};

}  // namespace strata::tools
