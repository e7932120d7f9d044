// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/beam_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/random/stream.hpp"
#include "tests/core/beam_filter/likelihoods.hpp"
#include "tests/core/beam_filter/walker_room.hpp"
#include "tests/support/same_bits.hpp"

namespace strata::beam_filter {
namespace {

using strata::test::same_bits;

TEST(FilterAtFixedPoses, FindsTheBeamsThatHitAWalker) {
  Room room = make_room(400, true, 1);
  WorkerPool pool(2);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
  std::size_t found = 0;
  std::size_t hits = 0;
  std::size_t walker = 0;
  std::size_t called = 0;
  for (std::size_t t = 0; t < room.scans.size(); ++t) {
    hits += count_beams(room.scans[t].scan).hits;
    for (std::size_t n = 0; n < kBeams; ++n) {
      const bool dynamic = room.scans[t].static_probability[n] < 0.5F;
      walker += room.is_dynamic[t][n] ? 1 : 0;
      called += dynamic ? 1 : 0;
      found += (dynamic && room.is_dynamic[t][n]) ? 1 : 0;
    }
  }
  ASSERT_GT(walker, 500U);
  EXPECT_GE(static_cast<double>(found), 0.90 * static_cast<double>(walker));
  EXPECT_GE(static_cast<double>(found), 0.85 * static_cast<double>(called));
  // A person who stands over the scanner is too close to count as a hit.
  EXPECT_NEAR(result.dynamic_fraction, static_cast<double>(called) / static_cast<double>(hits),
              1e-12);
}

TEST(FilterAtFixedPoses, ClearsTheTraceOfAWalkerFromTheMap) {
  Room room = make_room(400, true, 2);
  WorkerPool pool(2);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
  const ReflectionGrid raw = result.raw.reflection();
  auto ghosts = [](const ReflectionGrid& map) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Eigen::Vector2d at = map.center(map.cell(i));
      const bool inside = at.cwiseAbs().maxCoeff() < kHalfRoom_m - 0.3;
      if (inside && map.values()[i] > 0.01F) ++count;
    }
    return count;
  };
  ASSERT_GE(ghosts(raw), 50U);
  EXPECT_LE(10 * ghosts(result.filtered), ghosts(raw));
}

TEST(FilterAtFixedPoses, IteratesToTheClosedForm) {
  Room room = make_room(100, true, 3);
  WorkerPool pool(1);
  const FixedPoseResult closed = filter_at_fixed_poses(room.scans, exact_config(), pool);
  const FixedPoseResult iterated = filter_at_fixed_poses(room.scans, iterate_config(5'000), pool);
  ASSERT_EQ(closed.filtered.rect(), iterated.filtered.rect());
  double greatest = 0.0;
  for (std::size_t i = 0; i < closed.filtered.size(); ++i) {
    const float a = closed.filtered.values()[i];
    const float b = iterated.filtered.values()[i];
    ASSERT_EQ(is_known(a), is_known(b));
    if (is_known(a)) greatest = std::max(greatest, static_cast<double>(std::abs(a - b)));
  }
  EXPECT_LE(greatest, 1e-3);  // cells next to the threshold are still on their way
  EXPECT_NEAR(iterated.log_likelihood.back(), closed.log_likelihood.back(),
              1e-6 * std::abs(closed.log_likelihood.back()));
}

TEST(FilterAtFixedPoses, NeverLowersTheLikelihoodWhileIterating) {
  for (std::uint64_t seed = 10; seed < 20; ++seed) {
    Room room = make_room(60, true, seed);
    WorkerPool pool(1);
    BeamFilterConfig config = iterate_config(30);
    config.prior = RandomStream(seed, StreamId::kTest).uniform(0.6, 0.97);
    const FixedPoseResult result = filter_at_fixed_poses(room.scans, config, pool);
    ASSERT_EQ(result.log_likelihood.size(), static_cast<std::size_t>(result.iterations) + 1);
    EXPECT_GT(result.log_likelihood.back(), result.log_likelihood.front());
    for (std::size_t i = 1; i < result.log_likelihood.size(); ++i) {
      EXPECT_GE(result.log_likelihood[i],
                result.log_likelihood[i - 1] - 1e-9 * std::abs(result.log_likelihood[i]));
    }
  }
}

TEST(FilterAtFixedPoses, ReachesMostOfTheGainWithinSixRounds) {
  Room room = make_room(200, true, 4);
  WorkerPool pool(1);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, iterate_config(200), pool);
  const double first = result.log_likelihood.front();
  const double gain = result.log_likelihood.back() - first;
  EXPECT_GE(result.log_likelihood[6] - first, 0.9 * gain);
}

TEST(FilterAtFixedPoses, StopsWhenTheLikelihoodStopsRising) {
  Room room = make_room(100, true, 5);
  WorkerPool pool(1);
  BeamFilterConfig config = iterate_config(1'000);
  config.min_gain = 1e-4;
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, config, pool);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.iterations, 100);
  config.max_iterations = 1;
  EXPECT_FALSE(filter_at_fixed_poses(room.scans, config, pool).converged);
}

TEST(FilterAtFixedPoses, GivesTheSameBitsForAnyNumberOfThreads) {
  Room room = make_room(600, true, 6);
  WorkerPool one(1);
  const FixedPoseResult expected = filter_at_fixed_poses(room.scans, {}, one);
  const std::vector<PosedScan> labelled = room.scans;
  for (const int threads : {2, 8}) {
    WorkerPool pool(threads);
    const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
    EXPECT_TRUE(same_bits(result.filtered, expected.filtered));
    EXPECT_EQ(result.log_likelihood, expected.log_likelihood);
    for (std::size_t t = 0; t < labelled.size(); ++t) {
      ASSERT_EQ(room.scans[t].static_probability, labelled[t].static_probability);
    }
  }
}

TEST(FilterAtFixedPoses, LeavesAStaticWorldAsItCountsIt) {
  Room room = make_room(100, false, 7);
  WorkerPool pool(1);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
  const ReflectionGrid raw = result.raw.reflection();
  int always_hit = 0;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    ASSERT_EQ(is_known(raw.values()[i]), is_known(result.filtered.values()[i]));
    if (raw.values()[i] != 1.0F) continue;
    ++always_hit;
    EXPECT_EQ(result.filtered.values()[i], 1.0F);
  }
  EXPECT_GE(always_hit, 5);
  EXPECT_LT(result.dynamic_fraction, 0.01);
}

TEST(FilterAtFixedPoses, KeepsUnseenCellsUnknown) {
  Room room = make_room(20, false, 8);
  WorkerPool pool(1);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < result.filtered.size(); ++i) {
    const bool known = is_known(result.filtered.values()[i]);
    EXPECT_EQ(known, result.raw.cells().get(result.raw.cells().cell(i)).total() >= 0.5);
    unknown += known ? 0 : 1;
  }
  EXPECT_GT(unknown, 0U);
  EXPECT_FALSE(is_known(result.filtered.get({10'000, 10'000})));
}

TEST(FilterAtFixedPoses, AcceptsNoScansAndScansThatSayNothing) {
  WorkerPool pool(2);
  EXPECT_EQ(filter_at_fixed_poses({}, {}, pool).dynamic_fraction, 0.0);
  Room room = make_room(2, false, 9);
  std::fill(room.scans[0].scan.ranges_m.begin(), room.scans[0].scan.ranges_m.end(),
            std::numeric_limits<float>::quiet_NaN());
  std::fill(room.scans[1].scan.ranges_m.begin(), room.scans[1].scan.ranges_m.end(),
            std::numeric_limits<float>::infinity());
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, {}, pool);
  EXPECT_EQ(result.filtered.size(), 0U);
  const auto prior = static_cast<float>(BeamFilterConfig{}.prior);
  for (const float e : room.scans[0].static_probability) EXPECT_EQ(e, prior);
}

TEST(FilterAtFixedPoses, RefusesAWrongPrior) {
  WorkerPool pool(1);
  BeamFilterConfig config;
  config.prior = 0.5;
  EXPECT_THROW((void)filter_at_fixed_poses({}, config, pool), ConfigError);
}

class StopAtOnce : public Progress {
 public:
  void update(std::string_view, std::size_t, std::size_t) override { ++updates; }
  [[nodiscard]] bool cancelled() const override { return updates >= 2; }
  int updates = 0;
};

TEST(FilterAtFixedPoses, StopsWhenAskedTo) {
  Room room = make_room(600, false, 10);
  WorkerPool pool(2);
  StopAtOnce progress;
  EXPECT_THROW((void)filter_at_fixed_poses(room.scans, {}, pool, &progress), Cancelled);
  EXPECT_EQ(progress.updates, 2);
}

TEST(IncompleteLogLikelihood, IsTheSameFromCountsAndBeamByBeam) {
  Room room = make_room(50, true, 11);
  WorkerPool pool(1);
  for (const bool tolerant : {false, true}) {
    BeamFilterConfig config;
    config.endpoint_tolerance = tolerant;
    config.counting.no_return_free_range_m = 1.0;
    room.scans[3].scan.ranges_m[5] = std::numeric_limits<float>::infinity();
    const FixedPoseResult result = filter_at_fixed_poses(room.scans, config, pool);
    const double by_counts = incomplete_log_likelihood(result.raw, result.filtered, config);
    const double by_beams = incomplete_log_likelihood(room.scans, result.filtered, config);
    EXPECT_NEAR(by_counts, by_beams, 1e-9 * std::abs(by_beams));
    EXPECT_NEAR(by_counts, result.log_likelihood.back(), 1e-6 * std::abs(by_beams));
  }
}

TEST(ExpectedLogLikelihood, IsBelowTheIncompleteOneByTheEntropyOfTheLabels) {
  // ln p(z) = Q + H(e) when e is the posterior of the same map, so Q <= l.
  Room room = make_room(50, true, 12);
  WorkerPool pool(1);
  const FixedPoseResult result = filter_at_fixed_poses(room.scans, iterate_config(10), pool);
  for (std::size_t i = 0; i < result.log_likelihood.size(); ++i) {
    EXPECT_LE(result.expected_log_likelihood[i], result.log_likelihood[i]);
  }
}

Scan three_beams(float a, float b, float c) {
  Scan scan;
  scan.angle_min_rad = 0.0F;
  scan.angle_increment_rad = 0.0F;
  scan.range_max_m = 30.0F;
  scan.ranges_m = {a, b, c};
  return scan;
}

TEST(Label, GivesThePriorToBeamsThatTellNothing) {
  ReflectionGrid map = make_reflection_grid(0.1, {{0, 0}, {100, 1}});
  std::fill(map.values().begin(), map.values().end(), 0.3F);
  const float inf = std::numeric_limits<float>::infinity();
  BeamFilterConfig config;
  config.prior = 0.8;
  config.counting.max_range_m = 8.0;
  // no return; cut at the greatest range; outside the map
  const auto labels = label(three_beams(inf, 9.0F, 7.0F), {5.0, 0.05, 0.0}, map, config);
  EXPECT_EQ(labels, (std::vector<float>{0.8F, 0.8F, 0.8F}));
}

TEST(Label, FollowsTheCellWhereTheBeamEnds) {
  ReflectionGrid map(0.1, CellRect{{0, 0}, {100, 1}}, 0.0F);
  map.at({30, 0}) = 0.5F;
  map.at({40, 0}) = 1.0F;
  const auto labels =
      label(three_beams(2.05F, 3.05F, 4.05F), {0.0, 0.05, 0.0}, map, exact_config());
  EXPECT_EQ(labels[0], 0.0F);
  EXPECT_FLOAT_EQ(labels[1], static_cast<float>(exact_config().prior));
  EXPECT_EQ(labels[2], 1.0F);
}

// A wall on the border of two cells: noise leaves a tenth of its beams in the nearer one.
TEST(FilterCounts, ToleranceKeepsTheCellsBeforeAWall) {
  CountingMap raw(0.05);
  raw.cells() = TiledGrid<CellCounts>(0.05, CellRect{{0, 0}, {9, 1}});
  raw.cells().at({4, 0}) = {1.0, 9.0};
  raw.cells().at({5, 0}) = {9.0, 0.0};
  raw.cells().at({1, 0}) = {1.0, 9.0};  // someone passed
  const auto exact = filter_counts(raw, exact_config()).filtered;
  EXPECT_EQ(exact.at({4, 0}), 0.0F);
  EXPECT_EQ(exact.at({1, 0}), 0.0F);
  const auto tolerant = filter_counts(raw, {}).filtered;
  EXPECT_FLOAT_EQ(tolerant.at({4, 0}), 0.1F);
  EXPECT_EQ(tolerant.at({5, 0}), 1.0F);
  EXPECT_EQ(tolerant.at({1, 0}), 0.0F);
}

TEST(Label, ToleranceForgivesAnEndInTheNextCell) {
  ReflectionGrid map(0.1, CellRect{{0, 0}, {100, 3}}, 0.0F);
  map.at({30, 2}) = 1.0F;
  BeamFilterConfig config = exact_config();
  const Scan scan = three_beams(2.95F, 3.15F, 3.25F);
  const Pose2 laser{0.0, 0.15, 0.0};
  EXPECT_EQ(label(scan, laser, map, config), (std::vector<float>{0.0F, 0.0F, 0.0F}));
  config.endpoint_tolerance = true;
  EXPECT_EQ(label(scan, laser, map, config), (std::vector<float>{1.0F, 1.0F, 0.0F}));
}

}  // namespace
}  // namespace strata::beam_filter
