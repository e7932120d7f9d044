// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/few_beams.hpp"

#include <iostream>
#include <vector>

#include "tools/laboratory/experiments/simulated_slam.hpp"

namespace strata::experiments {

FewBeamsErrors drive_with_few_beams(const std::filesystem::path& scenario, int beams,
                                    std::uint64_t first, std::uint64_t last) {
  FewBeamsErrors errors;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
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
    const double slam_m = aligned_error_m(found_poses(learn_first_day(simulation)), truth);
    const double odometry_m = aligned_error_m(odometry, truth);
    errors.slam_m += slam_m;
    errors.odometry_m += odometry_m;
    errors.worse += slam_m > odometry_m ? 1 : 0;
  }
  const auto runs = static_cast<double>(last - first + 1);
  errors.slam_m /= runs;
  errors.odometry_m /= runs;
  return errors;
}

void report_few_beams(const std::filesystem::path& scenarios, std::uint64_t first, int seeds) {
  const std::uint64_t last = first + static_cast<std::uint64_t>(seeds) - 1;
  for (const char* world : {"corridor_people.yaml", "office.yaml"}) {
    for (const int beams : {5, 8, 12, 16, 32, 64}) {
      const FewBeamsErrors mean = drive_with_few_beams(scenarios / world, beams, first, last);
      std::cout << world << ", " << beams << " beams: " << mean.slam_m << " m, odometry alone "
                << mean.odometry_m << " m; worse than it in " << mean.worse << " of " << seeds
                << " runs\n";
    }
  }
}

}  // namespace strata::experiments
