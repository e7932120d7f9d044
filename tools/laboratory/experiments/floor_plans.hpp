// SPDX-License-Identifier: Apache-2.0
/// Drawn floor plans in the frames of maps, and robots that have nothing but a plan.
#pragma once

#include <cstdint>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/shards/units.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// Of one building.
struct PlanOutcome {
  double verdict = 0.0;  ///< plan::PlanVerdict
  double score = 0.0;
  double rival_score = 0.0;
  double map_share = 0.0;
  double plan_share = 0.0;
  double error_m = 0.0;  ///< mean over the ends of all walls, in the site's frame
  double worst_m = 0.0;
  double error_deg = 0.0;
  double foreign_verdict = 0.0;  ///< on the plan of another building
  double foreign_score = 0.0;
  double thick_m = 0.0;  ///< as DrawnPlan says
  double is_cut = 0.0;
  double said_scale_error = 0.0;  ///< of the drawing
  double scale_error = 0.0;       ///< of what was found
  double localized_m = 0.0;       ///< mean error of a drive on the plan alone, from the truth on
  double lost = 0.0;
  double searched_m = 0.0;  ///< the same from nowhere
  double searched_lost = 0.0;
};

/// Maps two days of it at good poses, registers a drawn plan of it and one of another building, and
/// localizes the third day on the plan alone.
[[nodiscard]] PlanOutcome try_plan(const simulate::ScenarioConfig& building,
                                   const simulate::ScenarioConfig& other, std::uint64_t seed);

/// Prints a line a building, and the sums, of random offices and of random floors.
void report_floor_plans(const Seeds& seeds, shards::Units& units);

}  // namespace strata::experiments
