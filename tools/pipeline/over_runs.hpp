// SPDX-License-Identifier: Apache-2.0
/// Figures of a model over its runs.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/pipeline/comparison.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {

/// Of every bootstrap interval, so that a report made twice says the same.
inline constexpr std::uint64_t kBootstrapSeed = 1;

/// The level of every test.
inline constexpr double kAlpha = 0.05;

/// Each run's mean error.
inline std::vector<double> run_means(const ModelResult& model) {
  std::vector<double> means;
  for (const ModelRun& run : model.runs) means.push_back(run.metrics.error_m.mean);
  return means;
}

/// Mean over the runs that have a value.
template <typename Get>
std::optional<double> mean_over_runs(const ModelResult& model, Get get) {
  std::vector<double> values;
  for (const ModelRun& run : model.runs) {
    if (const std::optional<double> value = get(run)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  return statistics::mean(values);
}

/// Mean over all runs.
template <typename Get>
double over_runs(const ModelResult& model, Get get) {
  return mean_over_runs(model, [&](const ModelRun& run) { return std::optional<double>(get(run)); })
      .value_or(0.0);
}

}  // namespace strata::pipeline
