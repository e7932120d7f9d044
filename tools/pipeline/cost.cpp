// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/cost.hpp"

#include <sys/resource.h>

namespace strata::pipeline {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

CostMeter::CostMeter()
    : wall_begin_(std::chrono::steady_clock::now()), cpu_begin_s_(cpu_seconds()) {}

Cost CostMeter::read() const {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_begin_;
  // ru_maxrss is in kilobytes on Linux.
  return {wall.count(), cpu_seconds() - cpu_begin_s_,
          static_cast<double>(usage.ru_maxrss) / 1024.0};
}

}  // namespace strata::pipeline
