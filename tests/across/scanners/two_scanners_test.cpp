// SPDX-License-Identifier: Apache-2.0
/// Two scanners of 270 degrees on opposite corners of a robot, scan by scan, against the one scan
/// all round that a merger would make of them.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/beam_filter/online_filter.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/across/scanners/two_scanner_drive.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata {
namespace {

using test::kBack;
using test::kFront;
using test::Log;
using test::place;
using test::record;
using test::Rig;
using test::room;

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

Outcome localize(const std::shared_ptr<const localization::SensorModel>& model, Rig rig,
                 std::uint64_t number = 0) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Log log = record(rig, seed, 60.0, number);
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

/// Two scanners' error less the merged scan's over many rooms.
struct Excess {
  std::vector<double> m;
  [[nodiscard]] double mean() const {
    return std::accumulate(m.begin(), m.end(), 0.0) / static_cast<double>(m.size());
  }
  [[nodiscard]] double standard_error() const {
    double sum = 0.0;
    for (const double value : m) sum += (value - mean()) * (value - mean());
    const auto count = static_cast<double>(m.size());
    return std::sqrt(sum / (count * (count - 1.0)));
  }
};

using MakeModel =
    std::function<std::shared_ptr<const localization::SensorModel>(const ReflectionGrid& map)>;

/// Prints it; no room is one that a setting was chosen in.
Excess excess_in_rooms(const char* name, const MakeModel& make_model, std::uint64_t rooms,
                       Rig merged, Rig two) {
  Excess excess;
  double merged_m = 0.0;
  for (std::uint64_t number = 1; number <= rooms; ++number) {
    const auto model = make_model(test::rasterize(room(number), 0.05, {{0, 0}, {240, 160}}));
    const double error_m = localize(model, merged, number).error_m;
    merged_m += error_m / static_cast<double>(rooms);
    excess.m.push_back(localize(model, two, number).error_m - error_m);
  }
  std::cout << name << (two == Rig::kTwoInTurn ? ", in turn" : ", in step") << ", " << rooms
            << (merged == Rig::kMerged ? " rooms, ideal: " : " rooms, merger: ") << 1e3 * merged_m
            << " mm, two more by " << 1e3 * excess.mean() << " mm, standard error "
            << 1e3 * excess.standard_error() << " mm\n";
  return excess;
}

// STRATA_SCANNER_ROOMS=40 for the figures of docs/sensors.md, with the ideal scan besides.
TEST(TwoScanners, LocalizeAsWellAsAMergerOfBothInRandomRooms) {
  const char* const given = std::getenv("STRATA_SCANNER_ROOMS");
  const std::uint64_t rooms = given != nullptr ? std::stoull(given) : 4;
  const std::pair<const char*, MakeModel> models[] = {
      {"beam model", [](const auto& map) { return localization::make_grid_beam_model(map); }},
      {"likelihood field",
       [](const auto& map) { return std::make_shared<localization::LikelihoodFieldModel>(map); }}};
  for (const auto& [name, make_model] : models) {
    for (const Rig two : {Rig::kTwoInTurn, Rig::kTwoInStep}) {
      const Excess excess = excess_in_rooms(name, make_model, rooms, Rig::kMerger, two);
      EXPECT_LT(excess.mean(), 2.0 * excess.standard_error());
      if (given != nullptr) (void)excess_in_rooms(name, make_model, rooms, Rig::kMerged, two);
    }
  }
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
    const Grid<CellCounts> cells = filter.counts().cells().dense();
    double sum = 0.0;
    for (const CellCounts& cell : cells.values()) sum += cell.hits;
    return sum;
  };
  // As many key scans, half of them with a fifth of the beams.
  EXPECT_NEAR(hits(both) / hits(front), 0.6, 0.05);
}

}  // namespace
}  // namespace strata
