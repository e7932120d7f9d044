// SPDX-License-Identifier: Apache-2.0
/// What `strata compare` is asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/pipeline/runs_input.hpp"

namespace strata::tools {

/// The command line of `strata compare`.
struct CompareOptions {
  pipeline::RunsInput input;
  std::vector<std::string> train;
  std::vector<std::string> test;
  std::vector<std::string> models;
  std::string out;
  std::optional<double> train_until_s;
  std::string map;
  std::string via = "direct";
  bool peers = false;
  bool json = false;
  bool buildings = false;
  int folds = 0;
  int seeds = 20;
  int jobs = 0;
  std::string shard;               ///< I/N; empty: the whole
  std::vector<std::string> merge;  ///< folders of shards; empty: compare
};

/// The logs that are compared in: LOG, or --train and then --test.
[[nodiscard]] inline pipeline::RunsInput input_of(const CompareOptions& options) {
  pipeline::RunsInput input = options.input;
  for (const auto* logs : {&options.train, &options.test}) {
    input.logs.insert(input.logs.end(), logs->begin(), logs->end());
  }
  return input;
}

}  // namespace strata::tools
