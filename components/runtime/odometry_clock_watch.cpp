// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/odometry_clock_watch.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace strata::runtime {
namespace {

/// Of a scan: each one more makes the estimate a little better, at a robot's cost.
constexpr int kMaxBeams = 180;
constexpr double kTurnOfPartRad = 1.0;
constexpr std::size_t kParts = 8;
/// A turn waits for odometry of kMaxOdometryLagS after it; more turns than this never wait.
constexpr std::size_t kMaxWaiting = 1000;
constexpr double kOdometryKeptS = 15.0;
constexpr double kMaxGapS = 1.0;
/// Two parts say the same.
constexpr double kSameS = 0.04;

}  // namespace

void OdometryClockWatch::begin_anew() { *this = {}; }

void OdometryClockWatch::add(const log::OdometrySample& sample) {
  if (!track_.empty() && sample.stamp <= track_.samples().back().stamp) return;
  track_.add(sample);
  track_.forget(kOdometryKeptS);
  const Duration reach = Duration::from_seconds(registration::kMaxOdometryLagS);
  while (!waiting_.empty() && waiting_.front().to + reach <= sample.stamp) {
    count(waiting_.front());
    waiting_.pop_front();
  }
}

void OdometryClockWatch::add(const Scan& scan) {
  if (last_ && !(scan.robot_from_laser == last_->robot_from_laser)) return;
  if (last_ && scan.stamp <= last_->stamp) return;
  if (last_) {
    const registration::ScanTurnConfig config{.max_beams = kMaxBeams};
    for (const auto& turn :
         registration::turns_of(std::vector<const Scan*>{&*last_, &scan}, config)) {
      if (waiting_.size() < kMaxWaiting) waiting_.push_back(turn);
    }
  }
  last_ = scan;
}

void OdometryClockWatch::count(const registration::ScanTurn& turn) {
  const Duration reach = Duration::from_seconds(registration::kMaxOdometryLagS);
  // Odometry began later, or what there was of it is forgotten.
  if (track_.samples().front().stamp > turn.from - reach) return;
  if (parts_.empty() || parts_.back().turned_rad >= kTurnOfPartRad) {
    parts_.emplace_back();
    if (parts_.size() > kParts) parts_.pop_front();
  }
  registration::LagPart& part = parts_.back();
  part.add(turn, [this](Stamp stamp) { return track_.at(stamp, kMaxGapS); });
  if (part.turned_rad < kTurnOfPartRad) return;
  const std::vector<registration::LagPart> all(parts_.begin(), parts_.end());
  const registration::OdometryLag lag = registration::lag_of_parts(all);
  const std::optional<double> before =
      std::exchange(found_s_, lag.certain ? std::optional(lag.lag_s) : std::nullopt);
  const bool is_sure = before && found_s_ && std::abs(*found_s_ - *before) <= kSameS;
  lag_s_ = is_sure ? found_s_ : std::nullopt;
}

}  // namespace strata::runtime
