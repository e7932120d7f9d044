// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/cost.hpp"

#include <algorithm>

#include <sys/resource.h>

namespace strata::pipeline {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

constexpr int kCounted[] = {RUSAGE_SELF, RUSAGE_CHILDREN};

double cpu_seconds() {
  double sum_s = 0.0;
  for (const int who : kCounted) {
    rusage usage{};
    getrusage(who, &usage);
    sum_s += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return sum_s;
}

double peak_rss_mb() {
  double peak_mb = 0.0;
  for (const int who : kCounted) {
    rusage usage{};
    getrusage(who, &usage);
    // ru_maxrss is in kilobytes on Linux.
    peak_mb = std::max(peak_mb, static_cast<double>(usage.ru_maxrss) / 1024.0);
  }
  return peak_mb;
}

}  // namespace

CostMeter::CostMeter()
    : wall_begin_(std::chrono::steady_clock::now()), cpu_begin_s_(cpu_seconds()) {}

Cost CostMeter::read() const {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_begin_;
  return {wall.count(), cpu_seconds() - cpu_begin_s_, peak_rss_mb()};
}

}  // namespace strata::pipeline
