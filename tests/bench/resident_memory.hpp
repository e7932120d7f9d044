// SPDX-License-Identifier: Apache-2.0
/// What this process holds in memory, and whether it grows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace strata::bench {

inline double resident_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmRSS:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1024.0;
  }
  return 0.0;
}

inline constexpr std::size_t kBlocks = 10;  ///< stretches of time that a slope is told from

struct Slope {
  double per_hour = 0.0;
  double plus_minus = 0.0;  ///< 95%
};

/// The slope of a line through the means of ten stretches of as many samples each, however long
/// those are: what lies near in time is alike, and samples that count as independent would make the
/// interval too narrow. At least ten samples.
inline Slope slope_of(const std::vector<double>& hours, const std::vector<double>& values) {
  std::vector<double> x(kBlocks, 0.0);
  std::vector<double> y(kBlocks, 0.0);
  std::vector<double> n(kBlocks, 0.0);
  for (std::size_t i = 0; i < hours.size(); ++i) {
    const std::size_t block = i * kBlocks / hours.size();
    x[block] += hours[i];
    y[block] += values[i];
    n[block] += 1.0;
  }
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    x[b] /= n[b];
    y[b] /= n[b];
    mean_x += x[b] / static_cast<double>(kBlocks);
    mean_y += y[b] / static_cast<double>(kBlocks);
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    xx += (x[b] - mean_x) * (x[b] - mean_x);
    xy += (x[b] - mean_x) * (y[b] - mean_y);
  }
  Slope slope{xy / xx, 0.0};
  double squares = 0.0;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const double off = y[b] - mean_y - slope.per_hour * (x[b] - mean_x);
    squares += off * off;
  }
  constexpr double kStudent = 2.31;  // 97.5% of Student's t with kBlocks - 2 = 8 degrees of freedom
  slope.plus_minus = kStudent * std::sqrt(squares / static_cast<double>(kBlocks - 2) / xx);
  return slope;
}

/// Samples of the robot's hours, and what they say once the first hour is over.
class MemoryCourse {
 public:
  void sample(double hours) {
    hours_.push_back(hours);
    mb_.push_back(resident_mb());
  }
  void tell(benchmark::State& state) const {
    const auto first = static_cast<std::size_t>(
        std::find_if(hours_.begin(), hours_.end(), [](double hours) { return hours >= 1.0; }) -
        hours_.begin());
    const std::vector<double> hours(hours_.begin() + static_cast<std::ptrdiff_t>(first),
                                    hours_.end());
    const std::vector<double> mb(mb_.begin() + static_cast<std::ptrdiff_t>(first), mb_.end());
    if (hours.size() < kBlocks) return state.SkipWithError("too short for a slope");
    const Slope slope = slope_of(hours, mb);
    state.counters["hours"] = hours.back();
    state.counters["mb_after_hour_1"] = mb.front();
    state.counters["mb_at_the_end"] = mb.back();
    state.counters["least_mb"] = *std::min_element(mb.begin(), mb.end());
    state.counters["most_mb"] = *std::max_element(mb.begin(), mb.end());
    state.counters["slope_mb_per_hour"] = slope.per_hour;
    state.counters["slope_plus_minus"] = slope.plus_minus;
  }

 private:
  std::vector<double> hours_;
  std::vector<double> mb_;
};

}  // namespace strata::bench
