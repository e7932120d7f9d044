// SPDX-License-Identifier: Apache-2.0
#include "core/slam/live_map.hpp"

#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Share of the cells known to both maps in which one says wall and the other free.
double disagreement(const ReflectionGrid& a, const ReflectionGrid& b) {
  std::size_t both = 0;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float here = a.values()[i];
    const float there = b.get(a.cell(i));
    if (!is_known(here) || !is_known(there)) continue;
    ++both;
    differ += is_occupied(here) != is_occupied(there) ? 1 : 0;
  }
  EXPECT_GT(both, 1'000U);
  return static_cast<double>(differ) / static_cast<double>(both);
}

std::size_t known_cells(const ReflectionGrid& map) {
  std::size_t known = 0;
  for (const float value : map.values()) known += is_known(value) ? 1 : 0;
  return known;
}

TEST(LiveMap, IsThereWithTheFirstScanAndHasNewsOnlyWhenItGrows) {
  const SlamConfig config;
  Slam slam(config);
  LiveMap map(config.beam_filter);
  EXPECT_TRUE(map.update(slam, kAll));
  EXPECT_FALSE(map.take_news());
  const auto log = test::record(test::ring(), test::drive_round(0.1, 2.0), 0, 5);
  slam.add(log[0]);
  EXPECT_TRUE(map.update(slam, kAll));
  EXPECT_TRUE(map.take_news());
  const std::size_t first = known_cells(map.occupancy());
  EXPECT_GT(first, 100U);
  EXPECT_GT(known_cells(map.filtered()), 100U);
  // A robot that stands adds nothing.
  Observation again = log[0];
  again.scan.stamp = log[0].scan.stamp + Duration::from_seconds(0.01);
  slam.add(again);
  EXPECT_TRUE(map.update(slam, kAll));
  EXPECT_FALSE(map.take_news());
  for (std::size_t i = 1; i < log.size(); ++i) slam.add(log[i]);
  EXPECT_TRUE(map.update(slam, kAll));
  EXPECT_TRUE(map.take_news());
  EXPECT_GT(known_cells(map.occupancy()), first);
}

/// Once and a half round, so that a loop closes and what was mapped before moves.
struct Drive {
  std::vector<Pose2> path = test::drive_round(0.1, 60.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 5);
};

TEST(LiveMap, FollowsTheScansThatALoopClosureMoves) {
  const Drive drive;
  const SlamConfig config;
  Slam slam(config);
  LiveMap following(config.beam_filter);
  for (const Observation& observation : drive.log) {
    slam.add(observation);
    following.update(slam, 8);
  }
  while (!following.update(slam, 8)) {
  }
  LiveMap at_once(config.beam_filter);
  EXPECT_TRUE(at_once.update(slam, kAll));
  EXPECT_LT(disagreement(following.occupancy(), at_once.occupancy()), 0.01);
  EXPECT_LT(disagreement(following.filtered(), at_once.filtered()), 0.01);
  // ... and is nearly the map that the end of the log makes.
  const SlamResult result = slam.finish();
  EXPECT_LT(disagreement(following.occupancy(), result.occupancy), 0.03);
}

TEST(LiveMap, LeavesOutARunThatIsNotPlacedYet) {
  const Drive drive;
  const SlamConfig config;
  Slam slam(config);
  LiveMap map(config.beam_filter);
  const std::size_t half = drive.log.size() / 2;
  for (std::size_t i = 0; i < half; ++i) slam.add(drive.log[i]);
  EXPECT_TRUE(map.update(slam, kAll));
  EXPECT_TRUE(map.take_news());
  Observation next = drive.log[half];
  next.run = 1;
  slam.add(next);
  // The end of the first run may move its scans, but the new one is not among them.
  std::size_t of_next_run = 0;
  slam.visit_mapped([&](const Slam::Mapped& mapped) { of_next_run += mapped.scan->run == 1; });
  EXPECT_EQ(of_next_run, 0U);
}

TEST(LiveMap, ShowsARunThatBeginsAtAKnownPlace) {
  const Drive drive;
  Slam slam(SlamConfig{});
  const std::size_t half = drive.log.size() / 2;
  Pose2Gaussian last;
  for (std::size_t i = 0; i < half; ++i) last = slam.add(drive.log[i]);
  last.covariance = Eigen::Matrix3d::Identity() * 0.01;
  slam.begin_next_run_at(last);
  Observation next = drive.log[half];
  next.run = 1;
  slam.add(next);
  std::size_t of_next_run = 0;
  slam.visit_mapped([&](const Slam::Mapped& mapped) {
    if (mapped.scan->run != 1) return;
    ++of_next_run;
    EXPECT_LT(translation_distance(mapped.map_from_robot, last.mean), 0.3);
  });
  EXPECT_EQ(of_next_run, 1U);
}

}  // namespace
}  // namespace strata::slam
