// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_input.hpp"

#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/log/joined_scan.hpp"
#include "components/log/odometry_clock.hpp"
#include "core/scan/no_return.hpp"

namespace strata::runtime {
namespace {

/// While something may still come for the first time, as many times max_waiting_scans may wait.
constexpr std::size_t kMoreAtFirst = 10;
constexpr const char* kHasStopped = "odometry has stopped on ";

}  // namespace

void SensorInput::add(const tf2_msgs::msg::TFMessage& transforms) {
  for (const auto& transform : transforms.transforms()) {
    if (!frames_.add_fixed(transform)) warn_not_finite("/tf_static", transform);
  }
}

void SensorInput::add_moving(const tf2_msgs::msg::TFMessage& transforms) {
  if (config_.tf_odometry_frame.empty()) return;
  const std::string frame = log::frame_name(config_.tf_odometry_frame);
  for (const auto& transform : transforms.transforms()) {
    if (log::frame_name(transform.header().frame_id()) != frame) {
      if (!frames_.add_moving(transform)) warn_not_finite("/tf", transform);
      const std::string other = log::frame_name(transform.header().frame_id());
      if (log::names_odometry(other)) other_odometry_frame_ = other;
      continue;
    }
    if (has_odometry_topic_) continue;
    const Pose3 pose = convert::from_message(transform.transform());
    if (!log::is_sound(pose)) {
      warn_not_finite("/tf", transform);
      continue;
    }
    add_odometry(moving_[log::frame_name(transform.child_frame_id())],
                 convert::from_message(transform.header().stamp()), planar(pose));
  }
}

void SensorInput::add(const nav_msgs::msg::Odometry& odometry) {
  moving_.clear();
  has_odometry_topic_ = true;
  topic_child_ = log::frame_name(odometry.child_frame_id());
  add_odometry(topic_odometry_, convert::from_message(odometry.header().stamp()),
               planar(convert::from_message(odometry.pose().pose())));
}

void SensorInput::add_odometry(LiveOdometry& odometry, Stamp stamp, const Pose2& odom_from_child) {
  if (!is_finite(odom_from_child)) {  // the scans about it find their neighbours
    ++bad_odometry_;
    warn(config_.odometry_topic + ": a pose is not finite; it is passed over");
    return;
  }
  if (source().odometry == nullptr || source().odometry == &odometry) {
    silence_.hear_odometry();
    told_.erase(without_odometry(kHasStopped));  // when it stops again it is told again
  }
  // What waits by the old clock goes on with what was known then.
  const auto set_back = [&](Stamp first) {
    if (!waits_ || source().odometry != &odometry) return;
    const Stamp latest = first + Duration::from_seconds(log::kMinSetBackS);
    if (queue_.size() == 0 || queue_.front().stamp() <= latest) return;
    clock_.begin_anew();
    while (queue_.size() > 0) release();
  };
  if (waits_ && source().odometry == &odometry) clock_.add({stamp, odom_from_child});
  // In lockstep the player has taken it off already.
  const Duration lag = Duration::from_seconds(waits_ ? lag_s_ : 0.0);
  odometry.add({stamp - lag, odom_from_child}, !waits_, set_back);
}

/// What the player sends in lockstep is by one clock already.
void SensorInput::watch_clock(const Observation& observation) {
  if (!waits_ || !observation.has_odometry) return;
  clock_.add(observation.scan);
  const std::optional<double> lag_s = clock_.lag_s();
  if (!lag_s || std::abs(*lag_s - lag_s_) < log::kMinOdometryLagS) return;
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << config_.odometry_topic << ": its stamps are "
       << std::abs(*lag_s) << " s too " << (*lag_s > 0.0 ? "late" : "early")
       << " for the scans, as turns show";
  if (config_.correct_odometry_lag) {
    lag_s_ = *lag_s;
    // What was stamped by the other clock is no neighbour of what comes.
    topic_odometry_.begin_anew();
    for (auto& [child, odometry] : moving_) odometry.begin_anew();
    text << "; corrected from here on, and from the start with odometry_lag_s: " << *lag_s;
  } else {
    text << "; set odometry_lag_s: " << *lag_s;
  }
  warn(text.str());
}

void SensorInput::add(const sensor_msgs::msg::LaserScan& scan, std::size_t topic) {
  const std::string name = config_.all_scan_topics()[topic];
  log::SensedScan sensed = log::sensed(scan, name);
  // In lockstep the player has asked the whole log.
  if (waits_ && config_.max_range_m > 0.0) {
    set_range_limit(sensed.scan, static_cast<float>(config_.max_range_m));
  }
  add_sensed(std::move(sensed), topic);
  warn_once(name + " angles", log::doubt_angles(scan));
}

void SensorInput::add(const sensor_msgs::msg::PointCloud2& cloud, std::size_t topic) {
  add_sensed(log::sensed(cloud), topic);
}

void SensorInput::add_sensed(log::SensedScan sensed, std::size_t topic) {
  if (!queue_.takes(topic, sensed.frame)) {
    ++of_new_frames_;
    return warn(config_.all_scan_topics()[topic] + ": scans come in ever new frames, " +
                std::to_string(ScanQueue::kMaxFrames) + " by now; those of others are left out: " +
                "have its driver send the same frame_id each time, and begin anew");
  }
  silence_.hear_scan(sensed.scan.stamp);
  queue_.add(topic, std::move(sensed), [this](Stamp first) {
    while (queue_.size() > 0) release();
    by_old_clock_ = ready_.size();
    silence_.hear_odometry();  // it is waited for anew
    clock_.begin_anew();
    gap_.begin_anew();
    ahead_s_.reset();
    // Odometry by the old clock would answer for moments of long ago.
    const Stamp old = first + Duration::from_seconds(log::kMinSetBackS);
    if (topic_odometry_.reaches(old)) topic_odometry_.begin_anew();
    for (auto& [child, odometry] : moving_) {
      if (odometry.reaches(old)) odometry.begin_anew();
    }
  });
}

SensorInput::Source SensorInput::source() const {
  if (has_odometry_topic_) return {&topic_odometry_, topic_child_};
  const auto own = moving_.find(log::frame_name(config_.robot_frame));
  if (own != moving_.end()) return {&own->second, own->first};
  for (const auto& [child, odometry] : moving_) {
    if (frames_.is_robots(child)) return {&odometry, child};
  }
  return {};
}

bool SensorInput::has_odometry_for(const WaitingScan& waiting, const Source& source) const {
  if (!config_.use_odometry) return true;
  if (source.odometry == nullptr || source.odometry->track().empty()) return is_without_odometry_;
  return source.odometry->reaches(waiting.end);
}

bool SensorInput::has_mounting(const WaitingScan& waiting, const Source& source) const {
  const std::string& frame = queue_.scanners()[waiting.scanner].frame;
  return assumed_.count(frame) != 0 || frames_.mounting(frame, source.child).has_value();
}

bool SensorInput::is_complete(const WaitingScan& waiting, const Source& source) const {
  return has_mounting(waiting, source) && has_odometry_for(waiting, source);
}

bool SensorInput::lacks_odometry(const Source& source) const {
  const bool is_silent = source.odometry == nullptr || source.odometry->track().empty();
  return config_.use_odometry && is_silent && !is_without_odometry_;
}

bool SensorInput::has_waited_long(const WaitingScan& oldest) const {
  const std::size_t most = static_cast<std::size_t>(config_.max_waiting_scans) * queue_.expected();
  if (queue_.size() <= most) return false;
  const Source from = source();
  if (has_mounting(oldest, from) && !lacks_odometry(from)) return true;
  // A count alone says little of time: a fast scanner's scans would be given up on before the
  // reader of odometry has met its writer.
  return queue_.size() > kMoreAtFirst * most ||
         (queue_.back().stamp() - oldest.stamp()).seconds() >= config_.first_wait_s;
}

/// Too many wait for the oldest: what nobody has published is not waited for again.
void SensorInput::give_up(const WaitingScan& waiting) {
  const Source from = source();
  if (!has_mounting(waiting, from)) assumed_.insert(queue_.scanners()[waiting.scanner].frame);
  if (lacks_odometry(from)) {
    const std::string& other = other_odometry_frame_;
    give_up_odometry(without_odometry("no odometry comes on ") +
                     (other.empty() ? ""
                                    : ". /tf has " + other +
                                          ": where that is this robot's, set "
                                          "tf_odometry_frame and odometry_frame to it"));
  } else if (!has_odometry_for(waiting, from) &&
             silence_.has_lasted(config_.first_wait_s, queue_.back().stamp())) {
    // What is on /tf, and was passed over for it, counts from now on, by its own clock.
    has_odometry_topic_ = false;
    lag_s_ = config_.odometry_lag_s;
    topic_odometry_ = {};
    moving_.clear();
    clock_.begin_anew();
    gap_.begin_anew();
    ahead_s_.reset();
    give_up_odometry(without_odometry(kHasStopped));
  }
}

void SensorInput::give_up_odometry(const std::string& sentence) {
  is_without_odometry_ = true;
  warn(sentence);
}

std::vector<Observation> SensorInput::take() {
  while (queue_.size() > 0) {
    if (waits_) {
      const bool is_overdue = has_waited_long(queue_.front());
      if (is_overdue) give_up(queue_.front());
      if (!is_overdue && !(is_complete(queue_.front(), source()) && queue_.is_next())) break;
    }
    release();
  }
  return std::exchange(ready_, {});
}

std::optional<std::size_t> SensorInput::take_set_back() {
  return std::exchange(by_old_clock_, std::nullopt);
}

std::optional<Pose2> SensorInput::moved_since(Stamp stamp) const {
  const Source from = source();
  if (!config_.use_odometry || from.odometry == nullptr || from.odometry->track().empty()) {
    return std::nullopt;
  }
  const log::OdometryTrack& track = from.odometry->track();
  const auto then = track.between_samples(stamp, config_.max_odometry_gap_s);
  if (!then) return std::nullopt;
  const Pose2 child_from_robot = frames_.robot_in(from.child);
  return between(log::moved_by(*then, child_from_robot),
                 log::moved_by(track.samples().back().odom_from_robot, child_from_robot));
}

void SensorInput::release() {
  const Source from = source();
  const bool is_in_time = has_odometry_for(queue_.front(), from);
  WaitingScan waiting = queue_.pop();
  const std::string& frame = queue_.scanners()[waiting.scanner].frame;
  const std::optional<Pose3> found = frames_.mounting(frame, from.child);
  if (!found) warn(frames_.missing_mounting(frame, from.child));
  const Pose3 mounting = found.value_or(Pose3{});
  if (!waiting.sensed.is_cloud) warn_once(frame + " tilt", log::doubt_mounting(frame, mounting));
  log::mount(waiting.sensed, mounting, config_.cloud);
  log::OdometryAt odometry;
  if (config_.use_odometry && from.odometry != nullptr && !from.odometry->track().empty()) {
    const log::OdometryTrack& track = from.odometry->track();
    const Pose2 child_from_robot = frames_.robot_in(from.child);
    // The nearest sample is as good as it gets only where no nearer one can come any more.
    odometry = [&track, child_from_robot, nearest = waits_ && is_in_time,
                gap_s = config_.max_odometry_gap_s](Stamp stamp) -> std::optional<Pose2> {
      const auto pose = nearest ? track.at(stamp, gap_s) : track.between_samples(stamp, gap_s);
      return pose ? std::optional(log::moved_by(*pose, child_from_robot)) : std::nullopt;
    };
    const bool has_odometry = odometry(waiting.stamp()).has_value();
    watch_gap(has_odometry, waiting.stamp(), *from.odometry);
    if (!has_odometry) {
      if (waits_ && is_in_time) {
        ++passed_over_;
        return;
      }
      odometry = nullptr;
    }
  }
  auto observation =
      log::join(std::move(waiting.sensed), odometry, {.reversed = is_upside_down(mounting)}, true);
  ready_.push_back(std::move(*observation));
}

}  // namespace strata::runtime
