// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/simulated_slam.hpp"

#include <cstddef>

#include "core/base/error.hpp"

namespace strata::experiments {

slam::SlamResult learn_first_day(const simulate::Simulation& simulation,
                                 const slam::SlamConfig& config) {
  slam::Slam slam(config);
  for (const simulate::SimulatedScan& scan : simulation.days[0].scans) slam.add(scan.observation);
  slam::SlamResult result = slam.finish();
  if (result.scans.size() != simulation.days[0].scans.size()) {
    throw Error("the simulated drive", "has scans that SLAM left out", "compare poses by stamps");
  }
  return result;
}

std::vector<Pose2> found_poses(const slam::SlamResult& result) {
  std::vector<Pose2> poses;
  for (const PosedScan& scan : result.scans) poses.push_back(scan.map_from_robot);
  return poses;
}

std::vector<Pose2> true_poses(const simulate::Simulation& simulation) {
  std::vector<Pose2> poses;
  for (const auto& scan : simulation.days[0].scans) poses.push_back(scan.map_from_robot);
  return poses;
}

double aligned_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  const Pose2 truth_from_map = align(poses, truth);
  double sum_m = 0.0;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    sum_m += translation_distance(truth_from_map * poses[t], truth[t]);
  }
  return sum_m / static_cast<double>(poses.size());
}

}  // namespace strata::experiments
