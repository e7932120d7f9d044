// SPDX-License-Identifier: Apache-2.0
/// Two forms of one loop, measured in turn in the same run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

namespace strata::bench {

/// Name of the SIMD target that kernels run with: the machine's best, or STRATA_SIMD_TARGET.
inline const char* simd_target() {
  const std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(targets & -targets);
}

/// CPU times of whole rounds; what else the machine does hits both forms.
class Ratios {
 public:
  /// A round begins, of one or more parts.
  void begin() {
    ours_.push_back(0.0);
    limit_.push_back(0.0);
  }
  template <typename Ours, typename Limit>
  void add(Ours&& ours, Limit&& limit) {
    ours_.back() += seconds_of(ours);
    limit_.back() += seconds_of(limit);
  }
  /// Counters ours_ns and limit_ns, medians for one of `items`, and ratio, the median of the
  /// rounds' quotients; the label is the SIMD target. Requires a round.
  void report(benchmark::State& state, double items) const {
    std::vector<double> ratios;
    for (std::size_t n = 0; n < ours_.size(); ++n) ratios.push_back(ours_[n] / limit_[n]);
    state.SetLabel(simd_target());
    state.counters["ours_ns"] = median(ours_) / items * 1e9;
    state.counters["limit_ns"] = median(limit_) / items * 1e9;
    state.counters["ratio"] = median(std::move(ratios));
  }

 private:
  static double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
  template <typename Body>
  static double seconds_of(Body&& body) {
    const double begin = cpu_seconds();
    body();
    return cpu_seconds() - begin;
  }
  static double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  std::vector<double> ours_, limit_;
};

/// Each iteration runs both. items: what `ours` and `limit` do at a time.
template <typename Ours, typename Limit>
void compare(benchmark::State& state, double items, Ours&& ours, Limit&& limit) {
  Ratios ratios;
  for (auto _ : state) {
    ratios.begin();
    ratios.add(ours, limit);
  }
  ratios.report(state, items);
}

}  // namespace strata::bench
