// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/truth_frame.hpp"

#include <cstddef>
#include <vector>

namespace strata::pipeline {

std::optional<Pose2> map_from_truth(const Runs& runs, std::span<const LearnedPose> learned) {
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  // Both are in the same order; SLAM may have skipped scans, and has those of earlier jobs.
  std::size_t next = 0;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    const Observation& observation = runs.observations[i];
    while (next < learned.size() && learned[next].run < observation.run) ++next;
    if (next == learned.size()) break;
    const LearnedPose& pose = learned[next];
    if (pose.run != observation.run || pose.stamp != observation.scan.stamp) continue;
    ++next;
    if (!runs.truths[i]) continue;
    source.push_back(*runs.truths[i]);
    target.push_back(pose.map_from_robot);
  }
  if (source.empty()) return std::nullopt;
  return align(source, target);
}

}  // namespace strata::pipeline
