// SPDX-License-Identifier: Apache-2.0
/// Which part of the logs is learned from, and which is localized in.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/scan/scan.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::pipeline {

/// Which observations belong to learning, and which to localization in what was learned.
struct Split {
  std::string name;
  std::vector<std::size_t> train;  ///< places in Runs::observations, in order
  std::vector<std::size_t> test;
};

/// The first `train_until_s` seconds are for learning; all logs count as one.
[[nodiscard]] Split split_by_time(const Runs& runs, const std::string& log, double train_until_s);
/// The first `train_runs` runs are for learning.
[[nodiscard]] Split split_by_run(const Runs& runs, const std::vector<std::string>& logs,
                                 int train_runs);
/// k splits: each fold is localized in maps of all others. Several logs: fold i is every k-th of
/// them, from i on; one log: the i-th of k equal pieces of its time. Throws InputError when there
/// are fewer logs, or scans, than folds, or k < 2.
[[nodiscard]] std::vector<Split> make_folds(const Runs& runs, const std::vector<std::string>& logs,
                                            int k);

/// What is learned from. A run whose middle is missing becomes two, so that nothing takes the gap
/// for motion.
[[nodiscard]] std::vector<Observation> learning_part(const Runs& runs, const Split& split);

/// Runs to localize in, over all splits.
[[nodiscard]] std::size_t count_drives(const Runs& runs, const std::vector<Split>& splits);

/// The values at these places, in order.
template <typename T>
std::vector<T> pick(const std::vector<T>& values, std::span<const std::size_t> places) {
  std::vector<T> picked;
  picked.reserve(places.size());
  for (const std::size_t place : places) picked.push_back(values[place]);
  return picked;
}

}  // namespace strata::pipeline
