// SPDX-License-Identifier: Apache-2.0
/// A MAPS folder of what was learned.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/maps/thinned_runs.hpp"
#include "core/geometry/pose2.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/report/drawings.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// What its summary says beside the maps.
struct LearnedFrom {
  std::string logs;                                   ///< their names
  std::optional<Pose2> map_from_truth;                ///< where truth was given
  const pipeline::CostMeter* meter;                   ///< since the job began
  std::vector<maps::ThinnedRun> thinned;              ///< of the earlier runs, after learning
  nlohmann::json reading = nlohmann::json::object();  ///< maps::summarize_reading
};

/// Writes the parts that were learned, pictures (`draw_more` adds some) and summary.json, puts the
/// folder in place and returns the summary. Notes pictures that could not be drawn. Throws
/// OutputError.
nlohmann::json write_learned(
    ResultDirectory& out, const pipeline::LearnResult& result, const pipeline::LearnParts& parts,
    const LearnedFrom& from, VerbContext& context,
    const std::function<void(const std::filesystem::path&, report::Drawings&)>& draw_more = {});

}  // namespace strata::tools
