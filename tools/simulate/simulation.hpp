// SPDX-License-Identifier: Apache-2.0
/// Runs a scenario: every day's drive, its scans, its odometry and the truth about all of it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/laser.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/simulate/space.hpp"
#include "tools/simulate/world.hpp"

namespace strata::simulate {

/// One scan with what the robot was told and what was true.
struct SimulatedScan {
  Observation observation;  ///< run: the day, from 0
  Pose2 map_from_robot;     ///< true pose
  std::vector<BeamSource> sources;
};

struct SimulatedDay {
  Stamp begin;  ///< of the first scan
  Stamp end;    ///< of the last
  std::vector<SimulatedScan> scans;
  std::vector<SimulatedCloud> clouds;
  std::vector<SimulatedImage> images;
};

/// Everything that a run of a scenario gives.
struct Simulation {
  ScenarioConfig scenario;
  std::uint64_t seed = 0;
  std::vector<Segment> walls;
  std::vector<ChangeableObject> objects;
  std::vector<SimulatedDay> days;
};

/// A scenario day by day, for those too long to be held whole. Gives the days of `simulate`.
class Simulator {
 public:
  /// Drives all days' ways, without scans. Throws ConfigError as `simulate`.
  Simulator(const ScenarioConfig& scenario, std::uint64_t seed);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Scenario, walls and objects, without days.
  [[nodiscard]] const Simulation& world() const;
  /// The next day, from the first to scenario.days; requires that there is one.
  [[nodiscard]] SimulatedDay next_day(Progress* progress = nullptr);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same scenario and seed give the same bits. The robot spends the night where it stops, so
/// truth and odometry go on without a jump and all days make one log. Throws ConfigError for a
/// scenario that contradicts itself; honours cancellation. O(scans x beams x obstacles), and
/// the same for the points of clouds and the pixels of images.
[[nodiscard]] Simulation simulate(const ScenarioConfig& scenario, std::uint64_t seed,
                                  Progress* progress = nullptr);

/// The scenario of a file (version: 1) with --set options on top; notes: what to tell the user of
/// its keys. Throws InputError, ConfigError.
[[nodiscard]] ScenarioConfig load_scenario(const std::string& file,
                                           const std::vector<std::string>& overrides = {},
                                           std::vector<std::string>* notes = nullptr);

}  // namespace strata::simulate
