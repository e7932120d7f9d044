// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/time_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace strata::runtime {

void TimeHistogram::add(double time_s) {
  ++count_;
  if (!std::isfinite(time_s)) return;
  const double time = std::max(time_s, 0.0);
  sum_s_ += time;
  for (std::size_t i = 0; i < kBounds_s.size(); ++i) {
    if (time <= kBounds_s[i]) ++up_to_[i];
  }
}

std::string TimeHistogram::text() const {
  std::string text;
  char number[32];
  for (std::size_t i = 0; i < kBounds_s.size(); ++i) {
    std::snprintf(number, sizeof number, "%g:", kBounds_s[i]);
    text += number + std::to_string(up_to_[i]) + " ";
  }
  std::snprintf(number, sizeof number, " sum:%.9g", sum_s_);
  return text + "inf:" + std::to_string(count_) + number;
}

}  // namespace strata::runtime
