// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/transients.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace strata::pipeline {
namespace {

constexpr double kDistance_m = 1.5;
constexpr double kClearance_m = 0.8;
constexpr double kPause_s = 30.0;
constexpr double kTryAgain_s = 2.0;
constexpr std::size_t kMinDuring = 10;
constexpr std::size_t kMinAfter = 3;
constexpr std::size_t kMaxAfter = 10;

/// Where a beam enters the obstacle; nothing when it passes.
std::optional<double> entry_into(const Eigen::Vector2d& laser_m, double angle_rad,
                                 const Transient& transient) {
  const Eigen::Vector2d offset = transient.center_m - laser_m;
  const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
  const double along_m = offset.dot(direction);
  const double beside2 = offset.squaredNorm() - along_m * along_m;
  const double half2 = transient.radius_m * transient.radius_m - beside2;
  if (along_m <= 0.0 || half2 <= 0.0) return std::nullopt;
  return std::max(0.0, along_m - std::sqrt(half2));
}

double reach_m(const Scan& scan, std::size_t beam) {
  if (scan.kind(beam) == BeamKind::kHit) return static_cast<double>(scan.ranges_m[beam]);
  return scan.kind(beam) == BeamKind::kNoReturn ? 1e9 : 0.0;
}

/// Beams that see what lies behind the place.
std::vector<std::uint32_t> beams_through(const Scan& scan, const Pose2& map_from_robot,
                                         const Transient& transient, double r_max_m) {
  std::vector<std::uint32_t> beams;
  const Pose2 laser = map_from_robot * scan.robot_from_laser;
  if ((laser.translation() - transient.center_m).norm() > r_max_m) return beams;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) != BeamKind::kHit || reach_m(scan, beam) >= r_max_m) continue;
    const auto entry =
        entry_into(laser.translation(), laser.theta + scan.bearing_rad(beam), transient);
    if (entry && *entry + 2.0 * transient.radius_m + kBinTolerance_m < reach_m(scan, beam)) {
      beams.push_back(static_cast<std::uint32_t>(beam));
    }
  }
  return beams;
}

/// Whether the obstacle fits here and is looked at; fills in when and by which scans.
bool fits(const TestScans& test, double r_max_m, std::size_t first, Transient& transient) {
  const Stamp begin = test.observations[first].scan.stamp;
  transient.first_scan = first;
  std::size_t during = 0;
  std::size_t i = first;
  for (; i < test.observations.size(); ++i) {
    const Scan& scan = test.observations[i].scan;
    if ((scan.stamp - begin).seconds() > kTransient_s) break;
    transient.last_scan = i;
    if (!test.truths[i]) continue;
    if ((test.truths[i]->translation() - transient.center_m).norm() < kClearance_m) return false;
    during += beams_through(scan, *test.truths[i], transient, r_max_m).size() >= kMinChangedBeams;
  }
  if (during < kMinDuring) return false;
  for (; i < test.observations.size() && transient.views.size() < kMaxAfter; ++i) {
    if (!test.truths[i]) continue;
    auto beams = beams_through(test.observations[i].scan, *test.truths[i], transient, r_max_m);
    if (beams.size() >= kMinChangedBeams) transient.views.emplace_back(i, std::move(beams));
  }
  return transient.views.size() >= kMinAfter;
}

/// To the left or right of a scan's robot, where the way is free.
std::optional<Transient> place_one(const TestScans& test, double r_max_m, std::size_t scan_index) {
  const Scan& scan = test.observations[scan_index].scan;
  const Pose2 laser = *test.truths[scan_index] * scan.robot_from_laser;
  for (const double degrees : {40.0, -40.0, 60.0, -60.0, 80.0, -80.0}) {
    const double bearing_rad = degrees * std::numbers::pi / 180.0;
    const double step_rad = static_cast<double>(scan.angle_increment_rad);
    const auto beam = static_cast<std::ptrdiff_t>(
        std::lround((bearing_rad - static_cast<double>(scan.angle_min_rad)) / step_rad));
    if (beam < 0 || beam >= static_cast<std::ptrdiff_t>(scan.size())) continue;
    Transient transient;
    if (reach_m(scan, static_cast<std::size_t>(beam)) < kDistance_m + 3.0 * transient.radius_m) {
      continue;
    }
    const double angle_rad = laser.theta + bearing_rad;
    transient.center_m = laser.translation() +
                         kDistance_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    if (fits(test, r_max_m, scan_index, transient)) return transient;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Transient> place_transients(const TestScans& test, double r_max_m, std::size_t most) {
  std::vector<Transient> placed;
  if (test.observations.empty()) return placed;
  const double limit_m = r_max_m > 0.0 ? r_max_m : 100.0;
  Stamp next = test.observations.front().scan.stamp;
  for (std::size_t i = 0; i < test.observations.size() && placed.size() < most; ++i) {
    const Stamp stamp = test.observations[i].scan.stamp;
    if (!test.truths[i] || stamp < next) continue;
    std::optional<Transient> transient = place_one(test, limit_m, i);
    next = stamp + Duration::from_seconds(transient ? kTransient_s + kPause_s : kTryAgain_s);
    if (transient) placed.push_back(std::move(*transient));
  }
  return placed;
}

Scan with_obstacle(const Scan& scan, const Pose2& map_from_robot, const Transient& transient) {
  Scan seen = scan;
  const Pose2 laser = map_from_robot * scan.robot_from_laser;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    const auto entry =
        entry_into(laser.translation(), laser.theta + scan.bearing_rad(beam), transient);
    if (entry && *entry < reach_m(scan, beam)) seen.ranges_m[beam] = static_cast<float>(*entry);
  }
  return seen;
}

FalseAdaptation follow_transients(const TestScans& test, const std::vector<Transient>& transients,
                                  double r_max_m, OnlinePredictor& undisturbed,
                                  OnlinePredictor& disturbed) {
  FalseAdaptation result;
  const double limit_m = r_max_m > 0.0 ? r_max_m : 100.0;
  for (std::size_t i = 0; i < test.observations.size(); ++i) {
    if (!test.truths[i]) continue;
    const Pose2& robot = *test.truths[i];
    Observation observation = test.observations[i];
    undisturbed.go_to(robot, observation.scan.stamp);
    disturbed.go_to(robot, observation.scan.stamp);
    for (const Transient& transient : transients) {
      const auto view = std::find_if(transient.views.begin(), transient.views.end(),
                                     [&](const auto& candidate) { return candidate.first == i; });
      if (view == transient.views.end()) continue;
      const maps::RangeFunction without = undisturbed.expected_range();
      const maps::RangeFunction with = disturbed.expected_range();
      const Pose2 laser = robot * observation.scan.robot_from_laser;
      for (const std::uint32_t beam : view->second) {
        const auto z_m = static_cast<double>(observation.scan.ranges_m[beam]);
        const double bearing_rad = observation.scan.bearing_rad(beam);
        const auto is_right = [&](const maps::RangeFunction& expected_range) {
          const double expected_m = std::min(expected_range(laser, bearing_rad), limit_m);
          return std::abs(expected_m - z_m) <= kBinTolerance_m;
        };
        if (!is_right(without)) continue;
        ++result.right;
        result.wrong += is_right(with) ? 0 : 1;
      }
    }
    undisturbed.learn(observation, robot);
    for (const Transient& transient : transients) {
      if (i < transient.first_scan || i > transient.last_scan) continue;
      observation.scan = with_obstacle(observation.scan, robot, transient);
    }
    disturbed.learn(observation, robot);
  }
  return result;
}

}  // namespace strata::pipeline
