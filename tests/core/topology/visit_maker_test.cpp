// SPDX-License-Identifier: Apache-2.0
#include "core/topology/visit_maker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/grid/reflection_grid.hpp"
#include "core/topology/landmark_detector.hpp"

namespace strata::topology {
namespace {

struct Box {
  double x0, y0, x1, y1;
  [[nodiscard]] bool has(double x, double y) const { return x > x0 && x < x1 && y > y0 && y < y1; }
};
using Floor = std::vector<Box>;  // where the robot can go

bool is_open(const Floor& floor, double x, double y) {
  return std::any_of(floor.begin(), floor.end(), [&](const Box& box) { return box.has(x, y); });
}

const Floor kCorridor{{-20.0, -1.0, 20.0, 1.0}};
const Floor kCrossing{{-20.0, -1.0, 20.0, 1.0}, {-1.0, -20.0, 1.0, 20.0}};
const Floor kBranching{{-20.0, -1.0, 20.0, 1.0}, {-1.0, -1.0, 1.0, 20.0}};
const Floor kCorner{{-20.0, -1.0, 1.0, 1.0}, {-1.0, -1.0, 1.0, 20.0}};
const Floor kRoom{{-20.0, -1.0, 20.0, 1.0}, {4.5, 0.9, 5.5, 1.2}, {3.0, 1.2, 7.0, 5.2}};

/// Everything known: free or wall.
ReflectionGrid map_of(const Floor& floor, double half_m) {
  const int half = static_cast<int>(half_m / 0.05);
  ReflectionGrid map = make_reflection_grid(0.05, {{-half, -half}, {half, half}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Eigen::Vector2d at = map.center(map.cell(i));
    map.values()[i] = is_open(floor, at.x(), at.y()) ? 0.0F : 1.0F;
  }
  return map;
}

TEST(OpenPlaces, AreCrossingsBranchingsCornersAndRoomsButNoPlaceOfACorridor) {
  const LandmarkConfig config;
  EXPECT_TRUE(open_places(map_of(kCorridor, 6.0), config).empty());
  for (const Floor& floor : {kCrossing, kBranching, kCorner}) {
    const std::vector<OpenPlace> places = open_places(map_of(floor, 6.0), config);
    ASSERT_EQ(places.size(), 1U);
    EXPECT_LT(places[0].at_m.norm(), 0.5);
  }
  const std::vector<OpenPlace> rooms = open_places(map_of(kRoom, 8.0), config);
  ASSERT_EQ(rooms.size(), 1U);
  EXPECT_LT((rooms[0].at_m - Eigen::Vector2d(5.0, 3.2)).norm(), 0.2);
  EXPECT_NEAR(rooms[0].clearance_m, 2.0, 0.1);
}

TEST(OpenPlaces, OfNothingKnownAreNone) {
  EXPECT_TRUE(open_places(ReflectionGrid{}, {}).empty());
  EXPECT_TRUE(open_places(make_reflection_grid(0.05, {{0, 0}, {50, 50}}), {}).empty());
}

/// What a laser sees from a pose, by small steps along each beam; 180 beams ahead.
PosedScan scan_at(const Floor& floor, const Pose2& pose, double time_s) {
  PosedScan posed;
  posed.map_from_robot = pose;
  posed.scan.stamp = Stamp::from_seconds(time_s);
  posed.scan.angle_min_rad = static_cast<float>(-std::numbers::pi / 2.0);
  posed.scan.angle_increment_rad = static_cast<float>(std::numbers::pi / 179.0);
  posed.scan.range_max_m = 30.0F;
  for (std::size_t i = 0; i < 180; ++i) {
    const double angle = pose.theta + posed.scan.bearing_rad(i);
    double range_m = 0.1;
    while (range_m < 29.0 &&
           is_open(floor, pose.x + range_m * std::cos(angle), pose.y + range_m * std::sin(angle))) {
      range_m += 0.02;
    }
    posed.scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return posed;
}

std::vector<MadeVisit> drive_through(const Floor& floor, VisitMaker& maker) {
  std::vector<MadeVisit> visits;
  const auto take = [&](std::vector<MadeVisit> made) {
    for (MadeVisit& visit : made) visits.push_back(std::move(visit));
  };
  for (int i = 0; i <= 80; ++i) {
    take(maker.add(scan_at(floor, {-8.0 + 0.2 * i, 0.1, 0.0}, 0.5 * i)));
  }
  take(maker.finish());
  return visits;
}

TEST(VisitMaker, VisitsACrossingOnceWhereItIsAndAPlainCorridorNever) {
  VisitMaker maker({});
  const std::vector<MadeVisit> visits = drive_through(kCrossing, maker);
  ASSERT_EQ(visits.size(), 1U);
  const Pose2& place = visits[0].visit.odom_from_robot;
  EXPECT_LT(place.translation().norm(), 0.3);
  EXPECT_NEAR(visits[0].visit.stamp.seconds(), 20.0, 1.5);
  EXPECT_GT(visits[0].visit.cloud.size(), 100U);
  // Walls of all four corridors, in the frame of the crossing.
  int behind = 0;
  int aside = 0;
  for (const Eigen::Vector2d& point : visits[0].visit.cloud.points_m) {
    behind += point.x() < -2.0 ? 1 : 0;
    aside += std::abs(point.y()) > 2.0 ? 1 : 0;
  }
  EXPECT_GT(behind, 10);
  EXPECT_GT(aside, 20);
  VisitMaker elsewhere({});
  EXPECT_TRUE(drive_through(kCorridor, elsewhere).empty());
}

/// Along the middle of a corridor, seen from y; one event a place. reach_m: of the scanner, whose
/// beams without return say that so much is free.
std::vector<LandmarkEvent> events_along(const Floor& floor, bool eastward, float reach_m = 30.0F,
                                        float free_range_m = 0.0F) {
  LandmarkDetector detector({});
  std::vector<LandmarkEvent> events;
  const auto take = [&](const std::vector<LandmarkEvent>& found) {
    events.insert(events.end(), found.begin(), found.end());
  };
  for (int i = 0; i <= 90; ++i) {
    const double x_m = -9.0 + 0.2 * i;
    const Pose2 pose = eastward ? Pose2{x_m, 0.1, 0.0} : Pose2{-x_m, 0.1, std::numbers::pi};
    PosedScan scan = scan_at(floor, pose, 0.5 * i);
    scan.scan.range_max_m = reach_m;
    scan.scan.free_range_m = free_range_m;
    take(detector.add(scan));
  }
  take(detector.finish());
  return events;
}

TEST(LandmarkDetector, IsToldNothingByBeamsWithoutReturn) {
  // A reach that shows too little of the crossing's corridors, unless what returns nothing is free.
  EXPECT_EQ(events_along(kCrossing, true, 10.0F).size(), 1U);
  EXPECT_EQ(events_along(kCrossing, true, 6.0F).size(), 0U);
  EXPECT_EQ(events_along(kCrossing, true, 6.0F, 12.0F).size(), 0U);
}

/// A hall whose near corners are seen only once the robot is inside.
TEST(LandmarkDetector, PutsAPlaceWhereItIsWhicheverWayTheRobotComes) {
  const Floor hall{{-20.0, -1.0, 20.0, 1.0}, {-3.0, -1.0, 2.0, 4.0}};
  const std::vector<LandmarkEvent> there = events_along(hall, true);
  const std::vector<LandmarkEvent> back = events_along(hall, false);
  ASSERT_EQ(there.size(), 1U);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_LT((there[0].center_m - back[0].center_m).norm(), LandmarkConfig{}.resolution_m);
  EXPECT_LT((there[0].center_m - Eigen::Vector2d(-0.5, 1.5)).norm(), 0.1);
}

/// Branchings on either side, a metre from each other along the corridor.
TEST(LandmarkDetector, FindsOneLandmarkWhereTwoFindingsLieTogether) {
  const Floor offset{{-20.0, -1.0, 20.0, 1.0}, {-1.5, -1.0, 0.5, 20.0}, {-0.5, -20.0, 1.5, 1.0}};
  for (const bool eastward : {true, false}) {
    const std::vector<LandmarkEvent> events = events_along(offset, eastward);
    ASSERT_FALSE(events.empty());
    for (std::size_t b = 1; b < events.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        EXPECT_GT((events[a].center_m - events[b].center_m).norm(), LandmarkConfig{}.same_m);
      }
    }
  }
}

TEST(VisitMaker, TakesLandmarksByHandInOrderOfTime) {
  LandmarkVisitConfig config;
  config.source = LandmarkSource::kGiven;
  VisitMaker maker(config);
  maker.mark(Stamp::from_seconds(30.0));
  maker.mark(Stamp::from_seconds(10.0));
  maker.mark(Stamp::from_seconds(10.1));  // the same scan: no second visit
  const std::vector<MadeVisit> visits = drive_through(kCorridor, maker);
  ASSERT_EQ(visits.size(), 2U);
  EXPECT_DOUBLE_EQ(visits[0].visit.stamp.seconds(), 10.0);
  EXPECT_DOUBLE_EQ(visits[1].visit.stamp.seconds(), 30.0);
  EXPECT_NEAR(visits[1].visit.path_length_m, 8.0, 1e-9);
  EXPECT_EQ(visits[0].robot_from_visit, Pose2{});
  EXPECT_EQ(maker.late(), 1U);
}

// Each visit costs more than the one before.
TEST(VisitMaker, MakesNoVisitOfEachScanWhoeverSaysHereAllTheTime) {
  LandmarkVisitConfig config;
  config.source = LandmarkSource::kGiven;
  VisitMaker maker(config);
  for (int i = 0; i <= 800; ++i) maker.mark(Stamp::from_seconds(0.05 * i));
  const std::vector<MadeVisit> visits = drive_through(kCorridor, maker);
  // Of 16 m in scans 0.2 m apart: 0.6 m is the least way that is half a metre.
  ASSERT_EQ(visits.size(), 27U);
  for (std::size_t i = 1; i < visits.size(); ++i) {
    EXPECT_NEAR(visits[i].visit.path_length_m, 0.6, 1e-9);
  }
  EXPECT_EQ(maker.late(), 801U - 27U);
}

TEST(VisitMaker, RefusesLandmarksThatAreTooLateOrTooMany) {
  LandmarkVisitConfig config;
  config.source = LandmarkSource::kGiven;
  VisitMaker maker(config);
  EXPECT_TRUE(maker.mark(Stamp::from_seconds(10.0)));
  ASSERT_EQ(drive_through(kCorridor, maker).size(), 1U);
  EXPECT_FALSE(maker.mark(Stamp::from_seconds(10.0)));
  EXPECT_FALSE(maker.mark(Stamp::from_seconds(9.0)));
  std::size_t taken = 0;
  for (int i = 0; i < 20'000; ++i) taken += maker.mark(Stamp::from_seconds(1e6 - i)) ? 1 : 0;
  EXPECT_EQ(taken, 10'000U);
  EXPECT_EQ(maker.late(), 10'002U);
}

TEST(VisitMaker, LeavesOutScansThatDoNotFollowAndMakesNothingOfNothing) {
  VisitMaker maker({});
  EXPECT_TRUE(maker.finish().empty());
  const PosedScan scan = scan_at(kCorridor, {}, 1.0);
  EXPECT_TRUE(maker.add(scan).empty());
  PosedScan blind = scan;
  blind.scan.stamp = Stamp::from_seconds(2.0);
  blind.scan.ranges_m.assign(180, std::numeric_limits<float>::quiet_NaN());
  blind.map_from_robot.x = 1.0;
  EXPECT_TRUE(maker.add(blind).empty());
  EXPECT_TRUE(maker.add(scan).empty());  // older
  EXPECT_TRUE(maker.finish().empty());
}

}  // namespace
}  // namespace strata::topology
