// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_map.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/slam/ring_world.hpp"

namespace strata::topology {
namespace {

/// Once round the block and a third of the way again, with poses whose heading drifts.
struct DriftingRound {
  std::vector<Pose2> truth = test::drive_round(0.1, 60.0);
  std::vector<Pose2> tracked;

  DriftingRound() {
    tracked.push_back(truth.front());
    for (std::size_t i = 1; i < truth.size(); ++i) {
      Pose2 step = between(truth[i - 1], truth[i]);
      step.theta += 0.002 * step.translation().norm();
      step.y += 0.01 * step.translation().norm();
      tracked.push_back(tracked.back() * step);
    }
  }
};

/// The largest error of a scan on the second round against the same place on the first.
double worst_between_rounds(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double worst = 0.0;
  for (std::size_t later = truth.size() - 50; later < truth.size(); ++later) {
    const auto same = std::find_if(truth.begin(), truth.end(), [&](const Pose2& pose) {
      return translation_distance(pose, truth[later]) < 0.06;
    });
    const auto earlier = static_cast<std::size_t>(same - truth.begin());
    const Pose2 found = between(poses[earlier], poses[later]);
    const Pose2 is = between(truth[earlier], truth[later]);
    worst = std::max(worst, translation_distance(found, is));
  }
  return worst;
}

// Behind the last landmark, or without any, only what the scans see of each other holds the way.
TEST(TopologyMap, LaysPassesOnEachOtherWhereNoLandmarkHoldsThem) {
  const DriftingRound round;
  TopologyMapperConfig config;
  config.landmarks.source = LandmarkSource::kGiven;
  TopologyMapper mapper(config, 1, 1);
  const std::vector<Observation> log = test::record(test::ring(), round.truth, 0, 7);
  for (std::size_t i = 0; i < log.size(); ++i) {
    EXPECT_TRUE(mapper.add(log[i], &round.tracked[i]).empty());
  }
  const TopologyMap map = make_topology_map(mapper);
  ASSERT_EQ(map.scans.size(), round.truth.size());
  std::vector<Pose2> found;
  for (const PosedScan& scan : map.scans) found.push_back(scan.map_from_robot);
  EXPECT_GT(worst_between_rounds(round.tracked, round.truth), 0.3) << "as it was tracked";
  EXPECT_LT(worst_between_rounds(found, round.truth), 0.05);
}

}  // namespace
}  // namespace strata::topology
