// SPDX-License-Identifier: Apache-2.0
#include "core/registration/correlative_search.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

MatchField field_from_scan(const Scan& scan, const Pose2& map_from_robot) {
  MatchField field(0.05);
  const Endpoints hits = endpoints_in_robot(scan);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Eigen::Vector2d at = map_from_robot * Eigen::Vector2d(hits.x_m[i], hits.y_m[i]);
    SurfacePoint point;
    point.x_m = at.x();
    point.y_m = at.y();
    field.add(point);
  }
  return field;
}

Scan full_scan(const Pose2& pose, int beams) {
  return test::scan_of(test::room(), pose, 0.0, 0.0, 1, beams, 2.0 * std::numbers::pi);
}

TEST(CorrelativeSearch, EqualsTryingEveryPose) {
  RandomStream random(11, StreamId::kTest);
  const CorrelativeConfig deep{.hit_stddev_m = 0.1, .depth = 5};
  const CorrelativeConfig flat{.hit_stddev_m = 0.1, .depth = 0};
  const Pose2 origin{5.0, 3.0, 0.0};
  const MatchField field = field_from_scan(full_scan(origin, 360), origin);
  const CorrelativeTables tables(field, deep);
  const CorrelativeTables plain(field, flat);
  for (int i = 0; i < 8; ++i) {
    const Pose2 truth{random.uniform(4.0, 6.0), random.uniform(2.0, 4.0),
                      random.uniform(-3.0, 3.0)};
    const Endpoints hits = subsample(endpoints_in_robot(full_scan(truth, 60)), 30);
    const Pose2 guess{truth.x + random.uniform(-0.4, 0.4), truth.y + random.uniform(-0.4, 0.4),
                      wrap_angle(truth.theta + random.uniform(-0.2, 0.2))};
    const SearchWindow window{0.5, 0.45, 0.25};
    const SearchResult fast = search(hits, tables, guess, window, 0.2);
    const SearchResult slow = search(hits, plain, guess, window, 0.2);
    ASSERT_EQ(fast.found, slow.found) << i;
    ASSERT_EQ(fast.pose, slow.pose) << i;
    ASSERT_DOUBLE_EQ(fast.score, slow.score) << i;
  }
}

TEST(CorrelativeSearch, TablesBoundEverythingTheyCover) {
  const Pose2 origin{5.0, 3.0, 0.0};
  const CorrelativeTables tables(field_from_scan(full_scan(origin, 180), origin),
                                 {.hit_stddev_m = 0.1, .depth = 4});
  RandomStream random(12, StreamId::kTest);
  for (int i = 0; i < 3000; ++i) {
    const int level = 1 + static_cast<int>(random.below(4));
    const Cell corner{static_cast<int>(random.below(220)) - 30,
                      static_cast<int>(random.below(200)) - 30};
    int greatest = 0;
    for (int y = 0; y < (1 << level); ++y) {
      for (int x = 0; x < (1 << level); ++x) {
        greatest = std::max(greatest, tables.at(0, {corner.x + x, corner.y + y}));
      }
    }
    ASSERT_EQ(tables.at(level, corner), greatest);
  }
}

TEST(CorrelativeSearch, FindsAPoseThatIsMetresAndHalfATurnOff) {
  const Pose2 origin{5.0, 3.0, 0.0};
  const CorrelativeTables tables(field_from_scan(full_scan(origin, 720), origin), {});
  const Pose2 truth{5.6, 2.5, 2.8};
  const Endpoints hits = subsample(endpoints_in_robot(full_scan(truth, 180)), 120);
  const SearchResult result =
      search(hits, tables, {3.5, 4.0, 0.0}, {3.0, 3.0, std::numbers::pi}, 0.5);
  ASSERT_TRUE(result.found);
  EXPECT_LT(translation_distance(result.pose, truth), 0.08);
  EXPECT_LT(std::abs(angle_difference(result.pose.theta, truth.theta)), 0.02);
}

TEST(CorrelativeSearch, FindsNothingBelowTheLeastScore) {
  const Pose2 origin{5.0, 3.0, 0.0};
  const CorrelativeTables tables(field_from_scan(full_scan(origin, 360), origin), {});
  const Endpoints hits = subsample(endpoints_in_robot(full_scan(origin, 180)), 60);
  EXPECT_FALSE(search(hits, tables, {25.0, 3.0, 0.0}, {0.5, 0.5, 0.2}, 0.3).found);
  EXPECT_FALSE(search({}, tables, origin, {0.5, 0.5, 0.2}, 0.3).found);
}

TEST(CorrelativeSearch, StaysAtTheGuessAlongABareWall) {
  MatchField field(0.05);
  for (int i = 0; i < 400; ++i) {
    SurfacePoint point;
    point.x_m = 0.05 * i + 0.025;
    point.y_m = 0.025;
    field.add(point);
  }
  Endpoints hits;
  for (int i = 0; i < 20; ++i) {
    hits.x_m.push_back(0.05 * i);
    hits.y_m.push_back(0.0);
    hits.beam.push_back(static_cast<std::uint32_t>(i));
  }
  const Pose2 guess{9.01, 0.21, 0.0};
  const SearchResult result =
      search(hits, CorrelativeTables(field, {}), guess, {1.0, 0.5, 0.1}, 0.5);
  ASSERT_TRUE(result.found);
  EXPECT_DOUBLE_EQ(result.pose.x, guess.x);
  EXPECT_NEAR(result.pose.y, 0.0, 0.05);
}

}  // namespace
}  // namespace strata::registration
