// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/transients.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/core/patch/toy_world.hpp"

namespace strata::pipeline {
namespace {

using patch::test_world::ToyRobot;
using patch::test_world::ToyWorld;

struct Drive {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
  [[nodiscard]] TestScans test() const { return {observations, truths, nullptr}; }
};

/// To and fro in a hall of 12 m x 6 m, for some minutes.
Drive to_and_fro() {
  ToyWorld world;
  world.add_box(0.0, 0.0, 12.0, 6.0);
  RandomStream random(5, StreamId::kTest);
  std::vector<PosedScan> scans;
  double time_s = 0.0;
  for (int leg = 0; leg < 12; ++leg) {
    const Pose2 left{1.5, 3.0, 0.0};
    const Pose2 right{10.5, 3.0, 0.0};
    ToyRobot().drive(world, leg % 2 == 0 ? left : right, leg % 2 == 0 ? right : left, 0, time_s, {},
                     random, scans);
    time_s = scans.back().scan.stamp.seconds() + 0.2;
  }
  Drive drive;
  for (const PosedScan& scan : scans) {
    Observation observation;
    observation.scan = scan.scan;
    drive.observations.push_back(observation);
    drive.truths.emplace_back(scan.map_from_robot);
  }
  return drive;
}

TEST(Transients, KeepClearOfTheRobotAndAreLookedThroughAfterwards) {
  const Drive drive = to_and_fro();
  const std::vector<Transient> placed = place_transients(drive.test(), 8.0);
  ASSERT_FALSE(placed.empty());
  for (const Transient& transient : placed) {
    const auto stamp = [&](std::size_t i) { return drive.observations[i].scan.stamp; };
    EXPECT_LE((stamp(transient.last_scan) - stamp(transient.first_scan)).seconds(), kTransient_s);
    for (std::size_t i = transient.first_scan; i <= transient.last_scan; ++i) {
      EXPECT_GE((drive.truths[i]->translation() - transient.center_m).norm(), 0.8);
    }
    for (const auto& [scan, beams] : transient.views) {
      EXPECT_GT(scan, transient.last_scan);
      EXPECT_GE(beams.size(), 3U);
    }
  }
}

TEST(Transients, ShortenJustTheBeamsThatMeetThem) {
  const Drive drive = to_and_fro();
  const Transient transient = place_transients(drive.test(), 8.0).front();
  const Scan& scan = drive.observations[transient.first_scan].scan;
  const Pose2 robot = *drive.truths[transient.first_scan];
  const Scan seen = with_obstacle(scan, robot, transient);
  std::size_t shortened = 0;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (seen.ranges_m[beam] == scan.ranges_m[beam]) continue;
    ++shortened;
    const Pose2 laser = robot * scan.robot_from_laser;
    const double angle = laser.theta + scan.bearing_rad(beam);
    const Eigen::Vector2d end =
        laser.translation() + static_cast<double>(seen.ranges_m[beam]) *
                                  Eigen::Vector2d(std::cos(angle), std::sin(angle));
    EXPECT_NEAR((end - transient.center_m).norm(), transient.radius_m, 1e-4);
    EXPECT_LT(seen.ranges_m[beam], scan.ranges_m[beam]);
  }
  EXPECT_GE(shortened, 3U);
}

/// Expects what the last learned scan measured, as long as that was at this pose; or the truth.
class Gullible final : public OnlinePredictor {
 public:
  Gullible(const Drive& drive, bool learns) : drive_(drive), learns_(learns) {}
  void go_to(const Pose2& robot, Stamp /*stamp*/) override { robot_ = robot; }
  maps::RangeFunction expected_range() override {
    return [this](const Pose2& /*laser*/, double bearing_rad) {
      return learns_ && fooled_ ? 0.5 : true_range(bearing_rad);
    };
  }
  void learn(const Observation& seen, const Pose2& /*robot*/) override {
    const Scan& real = drive_.observations[next_++].scan;
    fooled_ = fooled_ || seen.scan.ranges_m != real.ranges_m;
  }
  std::shared_ptr<const ReflectionGrid> map() override { return nullptr; }

 private:
  [[nodiscard]] double true_range(double bearing_rad) const {
    const Scan& real = drive_.observations[next_].scan;
    const double beam = (bearing_rad - static_cast<double>(real.angle_min_rad)) /
                        static_cast<double>(real.angle_increment_rad);
    return static_cast<double>(real.ranges_m[static_cast<std::size_t>(std::lround(beam))]);
  }
  const Drive& drive_;
  bool learns_;
  bool fooled_ = false;
  std::size_t next_ = 0;
  Pose2 robot_;
};

TEST(Transients, FoolAModelThatBelievesThemAndNoOther) {
  const Drive drive = to_and_fro();
  const std::vector<Transient> placed = place_transients(drive.test(), 8.0);
  for (const bool learns : {true, false}) {
    Gullible undisturbed(drive, learns);
    Gullible disturbed(drive, learns);
    const FalseAdaptation result =
        follow_transients(drive.test(), placed, 8.0, undisturbed, disturbed);
    EXPECT_GT(result.right, 0U);
    EXPECT_EQ(result.wrong, learns ? result.right : 0U);
  }
}

}  // namespace
}  // namespace strata::pipeline
