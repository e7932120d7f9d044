// SPDX-License-Identifier: Apache-2.0
/// Where in a log a player is.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "core/base/time.hpp"

namespace strata::player {

/// Stands at first, at the beginning of the log. Places are since there, and end after more than a
/// century, where they stay; whatever rates and times come, nothing overflows.
class PlayClock {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr Duration kLongest{4'000'000'000'000'000'000};
  /// wait() ends after this at the latest.
  static constexpr std::chrono::nanoseconds kLongestWait = std::chrono::hours(1);

  [[nodiscard]] double rate() const { return rate_; }
  /// rate: above 0. The clock goes on from where it is.
  void set_rate(double rate, Time now) {
    jump(position(now), now);
    rate_ = rate;
  }
  void run(bool runs, Time now) {
    jump(position(now), now);
    runs_ = runs;
  }
  void jump(Duration position, Time now) {
    from_ = std::clamp(position, Duration{}, kLongest);
    since_ = now;
  }
  [[nodiscard]] Duration position(Time now) const {
    if (!runs_) return from_;
    const std::chrono::duration<double, std::nano> elapsed = now - since_;
    const double passed_ns = std::max(elapsed.count(), 0.0) * rate_;
    const Duration left = kLongest - from_;
    if (passed_ns >= static_cast<double>(left.ns)) return kLongest;
    return from_ + Duration{static_cast<std::int64_t>(passed_ns)};
  }
  /// How long, by the clock on the wall, until that place is reached at this rate; 0 when it is.
  [[nodiscard]] std::chrono::nanoseconds wait(Duration place, Time now) const {
    const Duration here = position(now);
    if (place <= here) return {};
    const double wall_ns = static_cast<double>(place.ns - here.ns) / rate_;
    if (wall_ns >= static_cast<double>(kLongestWait.count())) return kLongestWait;
    return std::chrono::nanoseconds(static_cast<std::int64_t>(wall_ns) + 1);
  }

 private:
  Duration from_;  ///< was the place when the clock on the wall said since_
  Time since_;
  double rate_ = 1.0;
  bool runs_ = false;
};

}  // namespace strata::player
