// SPDX-License-Identifier: Apache-2.0
/// SLAM that gets no memory in the middle of its work loses the scan that it was at, and nothing
/// else: what it holds fits together, and it goes on. A program of its own, since it replaces the
/// global allocation functions.
#include <cstddef>
#include <cstdint>
#include <new>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "core/slam/slam.hpp"
#include "core/tracking/surface_map.hpp"
#include "tests/core/slam/ring_world.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::slam {
namespace {

/// Whether work got no memory at its allocation of that number.
template <typename Work>
bool fails_at(std::size_t number, Work&& work) {
  test::failing_allocation = test::allocations + number;
  bool has_failed = false;
  try {
    work();
  } catch (const std::bad_alloc&) {
    has_failed = true;
  }
  test::failing_allocation = 0;
  return has_failed;
}

/// Each occupied cell that a beam of the scan ended in has a point of its own.
void expect_points_of_their_own(const SurfaceMap& map, const Scan& scan, const Pose2& pose) {
  std::set<Cell> with_point;
  for (const registration::SurfacePoint& point : map.field().points()) {
    if (point.occupied) with_point.insert(cell_at({point.x_m, point.y_m}, 0.05));
  }
  const Endpoints hits = endpoints_in_robot(scan);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Eigen::Vector2d at = pose * Eigen::Vector2d(hits.x_m[i], hits.y_m[i]);
    if (map.state(at) != SurfaceState::kOccupied) continue;
    EXPECT_TRUE(with_point.contains(cell_at(at, 0.05))) << "beam " << hits.beam[i];
  }
}

TEST(MemoryRunsOut, AndEachCellOfASurfaceMapKeepsItsOwnHits) {
  const std::vector<Pose2> path = test::drive_round(0.4, 4.0);
  const std::vector<Observation> log = test::record(test::ring(), path, 0, 1);
  std::size_t failures = 0;
  for (std::size_t number = 1;; ++number) {
    SurfaceMap map(0.05, {});
    const auto add = [&](std::size_t i) { map.add(log[i].scan, path[i], {}, 30.0); };
    if (!fails_at(number, [&] { add(0); })) break;
    ++failures;
    for (int again = 0; again < 3; ++again) add(0);
    expect_points_of_their_own(map, log[0].scan, path[0]);
    if (HasFailure()) return;
  }
  EXPECT_GT(failures, 50U);
}

TEST(MemoryRunsOut, AndALocalMapIsAddedToAllListsOrToNone) {
  const std::vector<Pose2> path = test::drive_round(0.2, 30.0);
  const std::vector<Observation> log = test::record(test::ring(), path, 0, 3);
  Slam first({}, 1);
  std::size_t at = 0;  // the scan with which the second local map is whole
  std::vector<std::uint8_t> before;
  while (at < log.size() && first.kept_local_maps() < 2) {
    before = first.save_state();
    first.add(log[at++]);
  }
  ASSERT_EQ(first.kept_local_maps(), 2U);
  std::size_t failures = 0;
  for (std::size_t number = 1;; number += number < 300 ? 1 : 17) {
    Slam slam({}, 1);
    slam.restore_state(before, "slam");
    if (!fails_at(number, [&] { slam.add(log[at - 1]); })) break;
    ++failures;
    for (std::size_t i = at; i < log.size(); ++i) slam.add(log[i]);
    Slam other({}, 1);
    ASSERT_NO_THROW(other.restore_state(slam.save_state(), "slam")) << number;
  }
  EXPECT_GT(failures, 100U);
}

TEST(MemoryRunsOut, AndSlamStaysSoundAndGoesOn) {
  const std::vector<Pose2> path = test::drive_round(0.2, 60.0);
  const std::vector<Observation> log = test::record(test::ring(), path, 0, 3);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    RandomStream random(seed, StreamId::kTest, 7);
    Slam slam({}, 1);
    std::size_t failures = 0;
    for (const Observation& observation : log) {
      if (!random.bernoulli(0.5)) {
        slam.add(observation);
        continue;
      }
      const double most = random.bernoulli(0.5) ? 3000.0 : 60.0;
      const auto number = 1 + static_cast<std::size_t>(random.uniform(0.0, most));
      if (fails_at(number, [&] { slam.add(observation); })) ++failures;
    }
    EXPECT_GT(failures, 40U);
    Slam other({}, 1);
    ASSERT_NO_THROW(other.restore_state(slam.save_state(), "slam"));
    const SlamResult result = slam.finish();
    EXPECT_GT(result.scans.size(), log.size() / 2);
  }
}

}  // namespace
}  // namespace strata::slam
