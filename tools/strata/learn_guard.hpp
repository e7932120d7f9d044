// SPDX-License-Identifier: Apache-2.0
/// What `strata learn --update` asks before it replaces what was learned: that nothing is lost, and
/// nothing counted twice.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/maps/earlier_runs.hpp"
#include "core/slam/slam.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Throws OutputError when maps in `out` have a patch map or a timescale memory that those parts
/// would not write again. A memory cannot be made anew: most of what it saw is kept nowhere
/// else.
void require_no_lost_parts(const std::string& out, const pipeline::LearnParts& parts);

/// Throws OutputError when `out` holds runs that neither go on in what is learned nor are learned
/// again: visits that nobody has pushed, say. update: the folder that `base` was read from.
void require_no_lost_runs(const std::string& out, const std::string& update,
                          const maps::EarlierRuns& base, const std::vector<Observation>& seen);

/// A scan that was learned from, or is to be.
struct RunScan {
  int run = 0;
  const Scan* scan = nullptr;
};

/// The earlier run that a new one repeats: half of the scans of one of them are in the other with
/// the same stamps and readings, to the bit where a zone has not blinded them since. Nothing: none.
/// O(scans log scans).
[[nodiscard]] std::optional<int> repeated_run(std::span<const RunScan> earlier,
                                              std::span<const Observation> run);

/// Takes out runs that `earlier`, or a log before them, holds already, with a warning for each:
/// they would count twice. first_run: of the first log, as in read_runs. The names of the logs that
/// stay. O(scans log scans).
[[nodiscard]] std::vector<std::string> leave_out_repeated(pipeline::Runs& runs,
                                                          const std::vector<std::string>& logs,
                                                          int first_run,
                                                          const maps::EarlierRuns& earlier,
                                                          VerbContext& context);

/// Throws InputError, which names `update`, when no run from first_run on has a place in the map:
/// nothing was learned from any.
void require_a_place(const slam::SlamResult& result, const std::string& update, int first_run);

}  // namespace strata::tools
