// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/journal.hpp"

#include <chrono>
#include <utility>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"

namespace strata::localizer {
namespace {

/// Where the numbers of this life begin: behind those of any life before.
std::uint64_t first_scan_number() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace

Journal::Journal(std::shared_ptr<bus::RawWriter> scans, std::shared_ptr<bus::RawWriter> points,
                 std::function<RestorePoint()> make_point, const Limits& limits)
    : scans_(std::move(scans)),
      points_(std::move(points)),
      make_point_(std::move(make_point)),
      limits_(limits),
      next_scan_(first_scan_number()) {}

bool Journal::is_due(Stamp stamp) const {
  if (last_try_ && stamp >= *last_try_ && stamp - *last_try_ < limits_.period) return false;
  return is_interrupted_ || !last_point_ || stamp < *last_point_ ||
         stamp - *last_point_ >= limits_.period || points_->matched() > readers_;
}

void Journal::before(const Observation& observation, localization::Localizer& localizer) {
  const int readers = points_->matched();
  if (readers == 0) {
    last_point_.reset();  // who comes next begins anew
    last_try_.reset();
    lacks_points_ = false;
    readers_ = 0;
    return;
  }
  const Stamp stamp = observation.scan.stamp;
  if (!is_due(stamp)) return;
  auto state = localizer.saved_state(limits_.max_learned_bytes);
  lacks_points_ = !state;
  if (!state) {
    last_try_ = stamp;  // it may have been much work
    last_point_.reset();
    return;
  }
  last_try_.reset();
  RestorePoint point = make_point_();
  point.stamp = stamp;
  point.next_scan = next_scan_;
  point.goes_on = !std::exchange(is_interrupted_, false) && last_point_.has_value();
  point.state = std::move(*state);
  points_->publish(convert::to_cdr(to_message(point)));
  last_point_ = stamp;
  readers_ = readers;
}

void Journal::after(const Observation& observation, const Pose2Gaussian& map_from_robot,
                    const std::string& frame) {
  const std::uint64_t number = next_scan_++;
  if (scans_->matched() == 0) return;
  strata_msgs::msg::LabeledScan message = convert::to_message(
      PosedScan{observation.run, observation.scan, map_from_robot.mean, {}}, frame, "laser");
  message.pose().index(number);
  message.pose().map_from_robot(convert::to_message(map_from_robot));
  message.pose().odom_from_robot(convert::to_message(observation.odom_from_robot));
  message.pose().has_odometry(observation.has_odometry);
  scans_->publish(convert::to_cdr(message));
}

}  // namespace strata::localizer
