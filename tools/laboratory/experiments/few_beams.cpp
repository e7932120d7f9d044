// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/few_beams.hpp"

#include <iostream>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/simulated_slam.hpp"

namespace strata::experiments {

namespace {

/// Mean errors of one drive [m].
struct DriveErrors {
  double slam_m = 0.0;
  double odometry_m = 0.0;
};

DriveErrors drive(const std::filesystem::path& scenario, int beams, std::uint64_t seed) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario, {"days=1"});
  config.people.clear();
  config.laser.beams = beams;
  config.laser.field_of_view_deg = 360.0;
  const simulate::Simulation simulation = simulate::simulate(config, seed);
  std::vector<Pose2> odometry;
  for (const simulate::SimulatedScan& scan : simulation.days[0].scans) {
    odometry.push_back(scan.observation.odom_from_robot);
  }
  const std::vector<Pose2> truth = true_poses(simulation);
  return {aligned_error_m(found_poses(learn_first_day(simulation)), truth),
          aligned_error_m(odometry, truth)};
}

}  // namespace

FewBeamsErrors drive_with_few_beams(const std::filesystem::path& scenario, int beams,
                                    std::uint64_t first, std::uint64_t last, shards::Units& units) {
  FewBeamsErrors errors;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const std::string name = scenario.filename().string() + ", " + std::to_string(beams) +
                             " beams, seed " + std::to_string(seed);
    const auto one = units.of<DriveErrors>(name, [&] { return drive(scenario, beams, seed); });
    errors.slam_m += one.slam_m;
    errors.odometry_m += one.odometry_m;
    errors.worse += one.slam_m > one.odometry_m ? 1 : 0;
  }
  const auto runs = static_cast<double>(last - first + 1);
  errors.slam_m /= runs;
  errors.odometry_m /= runs;
  return errors;
}

void report_few_beams(const std::filesystem::path& scenarios, std::uint64_t first, int seeds,
                      shards::Units& units) {
  const std::uint64_t last = first + static_cast<std::uint64_t>(seeds) - 1;
  for (const char* world : {"corridor_people.yaml", "office.yaml"}) {
    for (const int beams : {5, 8, 12, 16, 32, 64}) {
      const FewBeamsErrors mean =
          drive_with_few_beams(scenarios / world, beams, first, last, units);
      std::cout << world << ", " << beams << " beams: " << mean.slam_m << " m, odometry alone "
                << mean.odometry_m << " m; worse than it in " << mean.worse << " of " << seeds
                << " runs\n";
    }
  }
}

}  // namespace strata::experiments
