// SPDX-License-Identifier: Apache-2.0
/// The ground truth of a replay: what each of its localizers was off by.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/replay_session.hpp"
#include "tools/strata/replay_truth.hpp"

namespace strata::tools {

/// The folders below `out` that have a file of that name. O(files).
[[nodiscard]] std::vector<std::filesystem::path> folders_with(const std::filesystem::path& out,
                                                              const char* file);

class ReplayTruths {
 public:
  /// is_given: false makes every call do nothing. runs: outlives this. Throws InputError for maps
  /// that cannot be read.
  ReplayTruths(bool is_given, const pipeline::Runs& runs, ReplaySession& session);
  /// Throws Error when a localizer's particle clouds are not heard.
  void wait_until_heard() const;
  /// After learning: finds where the truth lies in the maps that were saved below `out`, and writes
  /// it there.
  void align(const std::filesystem::path& out);
  /// Adds the errors to the metrics.json files below `out`.
  void write(const std::filesystem::path& out);

 private:
  const pipeline::Runs& runs_;
  bool is_given_;
  std::vector<std::unique_ptr<ReplayTruth>> localizers_;
};

}  // namespace strata::tools
