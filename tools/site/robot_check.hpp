// SPDX-License-Identifier: Apache-2.0
/// Which robot's visits contradict the map that all others' agree with: a bent laser, a lost robot,
/// another building.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/config.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::site {

/// When a visit is wrong. Both must hold: where the building changed all robots contradict the
/// map, and none of them is wrong.
struct RobotLimits {
  double max_contradicted = 0.25;
  double max_above_others = 0.2;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_contradicted", c.max_contradicted,
            {.doc = "so many of a visit's scans may contradict the map",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_above_others", c.max_above_others,
            {.doc = "... and so many more than of the median of the other robots",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
  }
};

struct RobotVisits {
  std::string robot;
  std::vector<std::span<const PosedScan>> visits;
};

struct VisitJudgement {
  std::size_t scans = 0;      ///< that the map can say something of
  double contradicted = 0.0;  ///< share of those
  std::string why;            ///< nothing is to be learned from it; empty: it is
};

struct RobotJudgement {
  std::string robot;
  std::size_t scans = 0;         ///< that the map can say something of
  double contradicted = 0.0;     ///< share of those, pipeline::FitState
  std::optional<double> others;  ///< median of the other robots; none can be compared with
  std::string why;               ///< most of its visits are wrong; empty: they are not
  std::vector<VisitJudgement> visits = {};  ///< in the order in which they were given
};

/// How much of what a robot saw contradicts the map; `others` and each `why` stay empty. O(beams
/// times cells on their way).
[[nodiscard]] RobotJudgement measure_robot(const ReflectionGrid& map, const RobotVisits& robot);

/// In the order of `robots`. map: the filtered one of the active version. Visits with fewer scans
/// than pipeline::kFitWindow of which the map can say something are judged together, and are not
/// where they have fewer together; nobody is compared with a robot that has fewer in all. O(beams
/// times cells on their way).
[[nodiscard]] std::vector<RobotJudgement> judge_robots(const ReflectionGrid& map,
                                                       std::span<const RobotVisits> robots,
                                                       const RobotLimits& limits);

}  // namespace strata::site
