// SPDX-License-Identifier: Apache-2.0
// What is told of a robot's messages, and to whom.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "components/runtime/sensor_input.hpp"

namespace strata::runtime {

void SensorInput::warn(const std::string& sentence) {
  if (told_.insert(sentence).second) warnings_.push_back(sentence);
}

void SensorInput::warn_once(const std::string& kind, const std::string& sentence) {
  if (!sentence.empty() && told_.insert(kind).second) warnings_.push_back(sentence);
}

std::vector<std::string> SensorInput::take_warnings() { return std::exchange(warnings_, {}); }

void SensorInput::warn_not_finite(const std::string& topic,
                                  const geometry_msgs::msg::TransformStamped& transform) {
  ++bad_transforms_;
  warn(topic + ": the transform of " + transform.child_frame_id() + " in " +
       transform.header().frame_id() + " is not finite; it is passed over");
}

std::string SensorInput::without_odometry(const std::string& what) const {
  return what + config_.odometry_topic + (config_.tf_odometry_frame.empty() ? "" : " or /tf") +
         "; scans go on without it";
}

void SensorInput::watch_gap(bool has_odometry, Stamp scan, const LiveOdometry& odometry) {
  if (!waits_) return;
  const Stamp newest_scan = queue_.size() > 0 ? std::max(scan, queue_.back().stamp()) : scan;
  const Stamp newest_odometry = odometry.track().samples().back().stamp;
  gap_.add(has_odometry, newest_scan, newest_odometry);
  ahead_s_ = gap_.ahead_s(config_.first_wait_s, newest_scan, newest_odometry);
  if (!ahead_s_) return;
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "scans are stamped " << std::abs(*ahead_s_) << " s "
       << (*ahead_s_ > 0.0 ? "after" : "before") << " the newest odometry of "
       << config_.odometry_topic << ", and "
       << (has_odometry ? "get odometry of another moment" : "find none of their moment")
       << ": see that one clock stamps both, when they are measured, and that neither comes late";
  constexpr double kMostLagS = 10.0;  // as odometry_lag_s may be
  const double lag_s = lag_s_ - *ahead_s_;
  if (std::abs(lag_s) <= kMostLagS) text << "; or set odometry_lag_s: " << lag_s;
  warn_once("gap", text.str());
}

void SensorInput::diagnose(Health& health) const {
  const Source from = source();
  for (const Scanner& scanner : queue_.scanners()) {
    if (assumed_.count(scanner.frame) != 0 && !frames_.mounting(scanner.frame, from.child)) {
      health.warn(frames_.missing_mounting(scanner.frame, from.child));
    }
    if (scanner.is_silent && !queue_.is_replaced(scanner)) {
      health.warn(config_.all_scan_topics()[scanner.topic] + " is silent; the others go on");
    }
  }
  if (is_without_odometry_ && (from.odometry == nullptr || from.odometry->track().empty())) {
    health.warn("no odometry comes; scans go on without it");
  }
  if (ahead_s_) {
    health.warn("scans and odometry are stamped far apart");
    health.add("scans are stamped after odometry by [s]", *ahead_s_);
  }
  if (lag_s_ != 0.0) health.add("taken off odometry's stamps [s]", lag_s_);
  if (clock_.lag_s()) health.add("odometry's stamps are late by [s]", *clock_.lag_s());
  health.add("scans without odometry near them", passed_over_);
  health.add("scans that came too late", std::uint64_t{queue_.late()});
  health.add("scans in ever new frames", of_new_frames_);
  health.add("transforms that are not finite", bad_transforms_);
  health.add("odometry that is not finite", bad_odometry_);
}

}  // namespace strata::runtime
