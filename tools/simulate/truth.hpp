// SPDX-License-Identifier: Apache-2.0
/// What was true in a simulation, as files: trajectory, states of doors and boxes, a picture.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/report/image.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::simulate {

/// The stamp of a moment of a day (from 1).
[[nodiscard]] Stamp stamp_at(const Simulation& simulation, int day, double at_s);

/// The states of an object over the recorded time: an entry at the first scan of each day and at
/// each change within a day.
[[nodiscard]] std::vector<std::pair<Stamp, std::size_t>> timeline(const Simulation& simulation,
                                                                  const ChangeableObject& object);

/// {"scenario", "seed", "days": [{"day", "begin_s", "end_s", "scans"}], "objects": [{"id", "kind",
/// "states", "rect": [x0, y0, x1, y1], "timeline": [{"time_s", "day", "state"}]}]}; times are
/// stamps of the log.
[[nodiscard]] std::string states_json(const Simulation& simulation);

/// The floor plan from above: walls black, each object's states in one colour a state, people's
/// paths dotted, the robot's true way blue.
[[nodiscard]] report::Image draw_world(const Simulation& simulation, int max_pixels = 1200);

}  // namespace strata::simulate
