// SPDX-License-Identifier: Apache-2.0
#include "core/localization/beyond_map.hpp"

#include <limits>
#include <utility>

namespace strata::localization {
namespace {

/// The tracker ends after so many weighed scans that the map judges whole: a robot that looks into
/// an unknown room from a corridor would begin anew at every door.
constexpr int kJudgedToEnd = 20;

/// Short local maps: they need to bridge a room, and are saved with the localizer.
slam::TrackingConfig tracking() {
  slam::TrackingConfig config;
  config.local_map_keys = 30;
  config.max_range_m = 20.0;
  return config;
}

constexpr double kResolution_m = 0.05;

}  // namespace

void BeyondMap::reset() {
  tracker_.reset();
  last_.reset();
  scans_ = matched_ = unmatched_ = 0;
  judged_in_a_row_ = 0;
  unjudged_share_ = 0.0;
  leads_ = false;
}

void BeyondMap::begin() {
  tracker_.emplace(tracking(), kResolution_m, 0, Pose2{});
  last_.reset();
  scans_ = 0;
}

void BeyondMap::settle() { matched_ = unmatched_ = 0; }

std::optional<Pose2> BeyondMap::follow(const Observation& observation) {
  if (!tracker_) return std::nullopt;
  const slam::TrackedScan found =
      tracker_->add(observation.scan,
                    observation.has_odometry ? &observation.odom_from_robot : nullptr, scans_++);
  (void)tracker_->take_finished();
  const std::optional<Pose2> before = std::exchange(last_, found.run_from_robot.mean);
  // In a corridor or a round hall the scan leaves open what odometry has to tell.
  const bool is_told = before && found.matched && !found.findings.ambiguous &&
                       !found.findings.heading_open && !found.findings.few;
  ++(is_told && leads_ ? matched_ : unmatched_);
  if (!before || !found.matched || !leads_) return std::nullopt;
  return between(*before, *last_);
}

MotionModelConfig BeyondMap::noise(const MotionModelConfig& of_odometry) const {
  MotionModelConfig config = of_odometry;
  if (!is_told()) return config;
  for (double* variance :
       {&config.rotation_from_rotation, &config.rotation_from_translation,
        &config.translation_from_translation, &config.translation_from_rotation}) {
    *variance *= config_.noise_share;
  }
  return config;
}

const Scan* BeyondMap::judged(const Scan& scan, const SensorModel& model,
                              const Pose2& map_from_robot, double stddev_m) {
  if (!config_.is_used) return &scan;
  // Where the robot is known to be outside, particles that have spread on the way know no better.
  const bool is_away = is_outside() && is_told();
  if (stddev_m > config_.max_stddev_m && !is_away) {
    judge_nothing();
    return &scan;
  }
  model.find_unjudged(scan, map_from_robot, is_unjudged_);
  std::size_t speaking = 0;
  std::size_t unjudged = 0;
  for (std::size_t beam = 0; beam < is_unjudged_.size(); ++beam) {
    const BeamKind kind = scan.kind(beam);
    if (kind != BeamKind::kHit && kind != BeamKind::kNoReturn) continue;
    ++speaking;
    unjudged += is_unjudged_[beam];
  }
  unjudged_share_ =
      speaking > 0 ? static_cast<double>(unjudged) / static_cast<double>(speaking) : 0.0;
  leads_ = is_beyond();
  if (!leads_) {
    if (tracker_ && ++judged_in_a_row_ >= kJudgedToEnd) tracker_.reset();
    return &scan;
  }
  judged_in_a_row_ = 0;
  if (!tracker_) begin();
  if (unjudged_share_ >= config_.coast_share && is_told()) return nullptr;
  part_ = scan;
  for (std::size_t beam = 0; beam < is_unjudged_.size(); ++beam) {
    if (is_unjudged_[beam] != 0) part_.ranges_m[beam] = std::numeric_limits<float>::quiet_NaN();
  }
  return &part_;
}

}  // namespace strata::localization
