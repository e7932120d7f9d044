// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/split.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace strata::pipeline {

Split split_by_time(const Runs& runs, const std::string& log, double train_until_s) {
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  Split split;
  split.name = log;
  for (std::size_t i = 0; i < elapsed.size(); ++i) {
    (elapsed[i] <= train_until_s ? split.train : split.test).push_back(i);
  }
  return split;
}

Split split_by_run(const Runs& runs, const std::vector<std::string>& logs, int train_runs) {
  Split split;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    (runs.observations[i].run < train_runs ? split.train : split.test).push_back(i);
  }
  for (std::size_t i = static_cast<std::size_t>(train_runs); i < logs.size(); ++i) {
    split.name += (split.name.empty() ? "" : " ") + logs[i];
  }
  return split;
}

std::vector<Split> make_folds(const Runs& runs, const std::vector<std::string>& logs, int k) {
  if (k < 2) throw InputError("--folds", "is below 2", "give at least 2");
  const bool by_run = logs.size() > 1;
  if (by_run && logs.size() < static_cast<std::size_t>(k)) {
    throw InputError("--folds", "is more than there are logs", "give at most one fold a log");
  }
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  std::vector<Split> splits(static_cast<std::size_t>(k));
  for (std::size_t i = 0; i < elapsed.size(); ++i) {
    const double share = elapsed.back() > 0.0 ? elapsed[i] / elapsed.back() : 0.0;
    const int fold = by_run ? runs.observations[i].run % k
                            : std::min(k - 1, static_cast<int>(share * static_cast<double>(k)));
    for (int f = 0; f < k; ++f) {
      Split& split = splits[static_cast<std::size_t>(f)];
      (f == fold ? split.test : split.train).push_back(i);
    }
  }
  for (int f = 0; f < k; ++f) {
    Split& split = splits[static_cast<std::size_t>(f)];
    if (!by_run) split.name = "piece " + std::to_string(f + 1) + " of " + std::to_string(k);
    for (std::size_t i = static_cast<std::size_t>(f); by_run && i < logs.size();
         i += static_cast<std::size_t>(k)) {
      split.name += (split.name.empty() ? "" : " ") + logs[i];
    }
  }
  return splits;
}

std::vector<Observation> learning_part(const Runs& runs, const Split& split) {
  std::vector<Observation> part = pick(runs.observations, split.train);
  int shift = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (i > 0 &&
        runs.observations[split.train[i]].run == runs.observations[split.train[i - 1]].run &&
        split.train[i] != split.train[i - 1] + 1) {
      ++shift;
    }
    part[i].run += shift;
  }
  return part;
}

std::size_t count_drives(const Runs& runs, const std::vector<Split>& splits) {
  std::size_t drives = 0;
  for (const Split& split : splits) {
    int run = -1;
    for (const std::size_t i : split.test) {
      drives += runs.observations[i].run != run ? 1 : 0;
      run = runs.observations[i].run;
    }
  }
  return drives;
}

}  // namespace strata::pipeline
