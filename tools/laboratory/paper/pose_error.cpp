// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/pose_error.hpp"

#include <cstddef>

#include "tools/evaluate/trajectory_error.hpp"

namespace strata::paper {

std::vector<log::StampedPose> stamped_truth(const pipeline::Runs& runs) {
  std::vector<log::StampedPose> truth;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    if (runs.truths[i]) truth.push_back({runs.observations[i].scan.stamp, *runs.truths[i]});
  }
  return truth;
}

double pose_error_m(std::span<const PosedScan> scans, std::span<const log::StampedPose> truth) {
  std::vector<log::StampedPose> found;
  for (const PosedScan& scan : scans) found.push_back({scan.scan.stamp, scan.map_from_robot});
  return tools::absolute_errors(found, truth, tools::alignment(found, truth)).translation_m.mean;
}

}  // namespace strata::paper
