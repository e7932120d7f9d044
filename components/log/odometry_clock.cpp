// SPDX-License-Identifier: Apache-2.0
#include "components/log/odometry_clock.hpp"

#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "core/registration/odometry_lag.hpp"

namespace strata::log {
namespace {

/// As ReadOptions::max_odometry_gap_s is by default.
constexpr double kMaxGapS = 1.0;
/// Of the cost without a lag; more is no reason to change a stamp.
constexpr double kMaxCostShare = 0.95;

OdometryTrack track_of_scans(const LogContent& content) {
  std::vector<OdometrySample> samples;
  for (const Observation& observation : content.observations) {
    samples.push_back({observation.scan.stamp, observation.odom_from_robot});
  }
  return OdometryTrack(std::move(samples));
}

}  // namespace

OdometryClock find_odometry_clock(const LogContent& content, const ReadReport& report) {
  OdometryClock clock;
  if (content.observations.empty() || !content.observations.front().has_odometry) return clock;
  const Pose2& mounting = content.observations.front().scan.robot_from_laser;
  std::vector<const Scan*> scans;
  for (const Observation& observation : content.observations) {
    // Of several scanners the first one.
    if (observation.scan.robot_from_laser == mounting) scans.push_back(&observation.scan);
  }
  const bool own = report.odometry_source == "scan" || report.sweep.delay_s != 0.0;
  const OdometryTrack track = own ? track_of_scans(content) : OdometryTrack(content.odometry);
  const registration::OdometryLag lag = registration::estimate_odometry_lag(
      registration::turns_of(scans), [&](Stamp stamp) { return track.at(stamp, kMaxGapS); });
  if (!lag.certain) return clock;
  clock.lag_s = lag.lag_s;
  const bool matters =
      std::abs(lag.lag_s) >= kMinOdometryLagS && lag.cost <= kMaxCostShare * lag.cost_without;
  if (matters) clock.corrected_s = lag.lag_s;
  return clock;
}

void shift_scan_odometry(LogContent& content, double lag_s) {
  const OdometryTrack track = track_of_scans(content);
  const Duration lag = Duration::from_seconds(lag_s);
  for (Observation& observation : content.observations) {
    const auto pose = track.at(observation.scan.stamp + lag, kMaxGapS);
    // Before the first and after the last scan odometry says no more than it did there.
    const auto& end = lag.ns < 0 ? track.samples().front() : track.samples().back();
    observation.odom_from_robot = pose.value_or(end.odom_from_robot);
  }
  for (OdometrySample& sample : content.odometry) sample.stamp = sample.stamp - lag;
}

std::string sentence_of(const OdometryClock& clock) {
  if (!clock.corrected_s) return "";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "odometry's stamps are "
       << std::abs(*clock.corrected_s) << " s too " << (*clock.corrected_s > 0.0 ? "late" : "early")
       << " for its scans" << (clock.is_given ? "" : ", as turns show") << "; corrected";
  if (!clock.is_given) text << " (--odometry-lag 0 leaves them)";
  return text.str();
}

}  // namespace strata::log
