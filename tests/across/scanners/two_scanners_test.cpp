// SPDX-License-Identifier: Apache-2.0
/// Two scanners of 270 degrees on opposite corners of a robot, scan by scan, against the one scan
/// all round that a merger would make of them.
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/beam_filter/online_filter.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata {
namespace {

using test::BoxWorld;

constexpr double kPi = std::numbers::pi;
constexpr double kNoise_m = 0.01;
const Pose2 kFront{0.3, 0.2, kPi / 4.0};
const Pose2 kBack{-0.3, -0.2, -3.0 * kPi / 4.0};

/// 12 m x 8 m with furniture and a wall across.
BoxWorld room() {
  return {{0.0, 0.0, 12.0, 0.2},  {0.0, 7.8, 12.0, 8.0}, {0.0, 0.0, 0.2, 8.0},
          {11.8, 0.0, 12.0, 8.0}, {5.0, 3.0, 7.4, 5.2},  {0.2, 6.6, 1.7, 7.8},
          {10.6, 0.2, 11.8, 1.1}, {3.0, 0.2, 4.1, 0.7},  {8.0, 7.1, 8.9, 7.8}};
}

Scan look(const Pose2& robot, const Pose2& mounting, double field_rad, int beams, double stamp_s,
          RandomStream& random) {
  static const BoxWorld world = room();
  const Pose2 laser = robot * mounting;
  Scan scan;
  scan.stamp = Stamp::from_seconds(stamp_s);
  scan.angle_min_rad = static_cast<float>(-0.5 * field_rad);
  scan.angle_increment_rad = static_cast<float>(field_rad / (beams - 1));
  scan.range_min_m = 0.05F;
  scan.range_max_m = 20.0F;
  scan.robot_from_laser = mounting;
  for (int i = 0; i < beams; ++i) {
    const double bearing = laser.theta + scan.bearing_rad(static_cast<std::size_t>(i));
    scan.ranges_m.push_back(static_cast<float>(test::cast(world, laser.x, laser.y, bearing) +
                                               kNoise_m * random.normal()));
  }
  return scan;
}

/// Round the furniture in the middle.
Pose2 place(double t) {
  const double phase = 0.14 * t;
  const double x = 6.2 + 4.0 * std::cos(phase);
  const double y = 4.1 + 2.4 * std::sin(phase);
  const double heading = std::atan2(2.4 * std::cos(phase), -4.0 * std::sin(phase));
  return {x, y, heading + 0.4 * std::sin(0.7 * t)};
}

struct Log {
  std::vector<Observation> observations;
  std::vector<Pose2> truths;
};

enum class Rig { kMerged, kTwoInTurn, kTwoInStep };

/// 10 Hz a scanner, one and a third of a round.
Log record(Rig rig, std::uint64_t seed, double duration_s = 60.0) {
  RandomStream noise(seed, StreamId::kTest);
  RandomStream wheels(seed, StreamId::kTest, 1);
  Log log;
  Pose2 odom = place(0.0);
  constexpr double kStepS = 0.05;
  const auto add = [&](const Pose2& robot, const Scan& scan) {
    log.observations.push_back({0, scan, odom, true});
    log.truths.push_back(robot);
  };
  for (int i = 0; i * kStepS < duration_s; ++i) {
    const double t = i * kStepS;
    const Pose2 robot = place(t);
    if (i > 0) {
      const Pose2 motion = between(place(t - kStepS), robot);
      odom = odom * Pose2{motion.x * (1.02 + 0.1 * wheels.normal()), motion.y,
                          motion.theta * (1.02 + 0.1 * wheels.normal())};
    }
    const bool is_even = i % 2 == 0;
    if (rig == Rig::kMerged && is_even) {
      add(robot, look(robot, {}, 2.0 * kPi - 2.0 * kPi / 720.0, 720, t, noise));
    }
    if (rig != Rig::kMerged && is_even) {
      add(robot, look(robot, kFront, 1.5 * kPi, 541, t, noise));
    }
    if ((rig == Rig::kTwoInTurn && !is_even) || (rig == Rig::kTwoInStep && is_even)) {
      add(robot, look(robot, kBack, 1.5 * kPi, 541, t, noise));
    }
  }
  return log;
}

struct Outcome {
  double error_m = 0.0;
  double error_rad = 0.0;
  std::size_t weighed_front = 0;
  std::size_t weighed_back = 0;
  std::size_t poses = 0;

  void add(const Pose2& off) {
    error_m += std::hypot(off.x, off.y);
    error_rad += std::abs(off.theta);
    ++poses;
  }
  void average() {
    error_m /= static_cast<double>(poses);
    error_rad /= static_cast<double>(poses);
  }
};

Outcome localize(const std::shared_ptr<const localization::SensorModel>& model, Rig rig) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Log log = record(rig, seed);
    localization::Localizer localizer({}, model, seed);
    localizer.initialize({log.truths[0], Eigen::Vector3d(0.02, 0.02, 0.005).asDiagonal()});
    for (std::size_t i = 0; i < log.observations.size(); ++i) {
      const auto& result = localizer.update(log.observations[i]);
      if (result.weighed) {
        const bool is_front = log.observations[i].scan.robot_from_laser == kFront;
        ++(is_front ? outcome.weighed_front : outcome.weighed_back);
      }
      if (i < 100) continue;
      const Pose2 off = between(log.truths[i], result.pose.mean);
      outcome.add(off);
    }
  }
  outcome.average();
  return outcome;
}

/// The position no worse than from the merged scan, the heading by at most a tenth.
void expect_as_good(const std::shared_ptr<const localization::SensorModel>& model) {
  const Outcome merged = localize(model, Rig::kMerged);
  for (const Rig rig : {Rig::kTwoInTurn, Rig::kTwoInStep}) {
    const Outcome two = localize(model, rig);
    EXPECT_LT(two.error_m, merged.error_m);
    EXPECT_LT(two.error_rad, 1.1 * merged.error_rad);
    // Both have their turns. Two that are weighed together have the beams of one.
    EXPECT_NEAR(two.weighed_front, two.weighed_back, 20.0);
    EXPECT_LT(two.weighed_front + two.weighed_back, 1.1 * static_cast<double>(merged.weighed_back));
  }
}

TEST(TwoScanners, LocalizeAsWellAsTheMergedScan) {
  const ReflectionGrid map = test::rasterize(room(), 0.05, {{0, 0}, {240, 160}});
  expect_as_good(localization::make_grid_beam_model(map));
  expect_as_good(std::make_shared<localization::LikelihoodFieldModel>(map));
}

/// The rigid motion that lays the poses on the truth best.
Pose2 alignment(const std::vector<PosedScan>& scans, const std::vector<Pose2>& truths) {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  const auto count = static_cast<double>(scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    from += scans[i].map_from_robot.translation() / count;
    to += truths[i].translation() / count;
  }
  double sine = 0.0;
  double cosine = 0.0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Eigen::Vector2d a = scans[i].map_from_robot.translation() - from;
    const Eigen::Vector2d b = truths[i].translation() - to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double theta = std::atan2(sine, cosine);
  const Eigen::Vector2d shift = to - Eigen::Rotation2Dd(theta) * from;
  return {shift.x(), shift.y(), theta};
}

Outcome map(Rig rig) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Log log = record(rig, seed);
    slam::Slam slam({});
    for (const Observation& observation : log.observations) slam.add(observation);
    const slam::SlamResult result = slam.finish();
    EXPECT_EQ(result.scans.size(), log.observations.size());
    const Pose2 truth_from_map = alignment(result.scans, log.truths);
    for (std::size_t i = 0; i < result.scans.size(); ++i) {
      EXPECT_EQ(result.scans[i].static_probability.size(), result.scans[i].scan.size());
      EXPECT_EQ(result.scans[i].scan.robot_from_laser, log.observations[i].scan.robot_from_laser);
      const Pose2 off = between(log.truths[i], truth_from_map * result.scans[i].map_from_robot);
      outcome.add(off);
    }
  }
  outcome.average();
  return outcome;
}

TEST(TwoScanners, MapAsWellAsTheMergedScan) {
  const Outcome merged = map(Rig::kMerged);
  for (const Rig rig : {Rig::kTwoInTurn, Rig::kTwoInStep}) {
    const Outcome two = map(rig);
    EXPECT_LT(two.error_m, merged.error_m);
    EXPECT_LT(two.error_rad, merged.error_rad);
  }
}

/// Mountings of the scans that passed a gate.
template <typename Taken>
std::vector<std::size_t> by_scanner(const Log& log, const Taken& is_taken) {
  std::vector<std::size_t> taken(2, 0);
  for (std::size_t i = 0; i < log.observations.size(); ++i) {
    const Scan& scan = log.observations[i].scan;
    if (is_taken(PosedScan{0, scan, log.truths[i], {}})) ++taken[scan.robot_from_laser == kBack];
  }
  return taken;
}

TEST(TwoScanners, BothComeIntoTheTimescaleMemory) {
  for (const Rig rig : {Rig::kTwoInTurn, Rig::kTwoInStep}) {
    memory::TimescaleMemory memory({}, 1);
    const auto taken = by_scanner(record(rig, 1), [&](const PosedScan& scan) {
      return memory.observe(scan).outcome == memory::ObserveOutcome::kTaken;
    });
    EXPECT_GT(taken[0], 2 * taken[1] / 3);
    EXPECT_GT(taken[1], 2 * taken[0] / 3);
  }
}

TEST(TwoScanners, BothStayInTheMapOfTheOnlineFilter) {
  beam_filter::WindowConfig window;
  window.scans = 10;
  beam_filter::OnlineFilter both({}, window);
  beam_filter::OnlineFilter front({}, window);
  for (const Observation& observation : record(Rig::kTwoInStep, 1, 40.0).observations) {
    PosedScan scan{0, observation.scan, place(observation.scan.stamp.seconds()), {}};
    if (scan.scan.robot_from_laser == kFront) {
      front.add(scan);
    } else {
      scan.scan.ranges_m.resize(109);  // a fifth, so that hits tell whose scans they are of
    }
    EXPECT_EQ(both.add(scan).size(), scan.scan.size());
  }
  const auto hits = [](const beam_filter::OnlineFilter& filter) {
    double sum = 0.0;
    for (const CellCounts& cell : filter.counts().cells().dense().values()) sum += cell.hits;
    return sum;
  };
  // As many key scans, half of them with a fifth of the beams.
  EXPECT_NEAR(hits(both) / hits(front), 0.6, 0.05);
}

}  // namespace
}  // namespace strata
