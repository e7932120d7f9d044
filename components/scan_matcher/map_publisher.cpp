// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/map_publisher.hpp"

#include <algorithm>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/runtime/share_of_time.hpp"

namespace strata::scan_matcher {
namespace {

/// Where a closure moves more, the rest waits for the next turn: scans must not wait long.
constexpr std::size_t kMaxMoved = 200;
/// The trajectory goes out when it has grown by so much, or when poses in it have moved.
constexpr double kLonger = 1.1;

nav_msgs::msg::Path to_path(const slam::Slam& slam, Stamp stamp, const std::string& map_frame) {
  nav_msgs::msg::Path path;
  path.header(convert::make_header(stamp, map_frame));
  slam.visit_kept([&](const slam::Slam::Mapped& mapped) {
    geometry_msgs::msg::PoseStamped pose;
    pose.header(convert::make_header(mapped.scan->scan.stamp, map_frame));
    pose.pose(convert::to_pose(mapped.map_from_robot));
    path.poses().push_back(std::move(pose));
  });
  return path;
}

}  // namespace

MapPublisher::MapPublisher(double every_s, const beam_filter::BeamFilterConfig& config,
                           std::string map_frame, Topics topics)
    : every_s_(every_s),
      map_frame_(std::move(map_frame)),
      topics_(std::move(topics)),
      map_(config) {}

void MapPublisher::update(const slam::Slam& slam, Stamp stamp) {
  const Clock::time_point begin = Clock::now();
  if (every_s_ <= 0.0 || begin < due_) return;
  const bool is_done = map_.update(slam, kMaxMoved);
  if (map_.take_news()) publish(slam, stamp);
  const std::chrono::duration<double> every(is_done ? every_s_ : 0.0);
  due_ = std::max(runtime::next_turn(begin),
                  Clock::now() + std::chrono::duration_cast<Clock::duration>(every));
}

void MapPublisher::publish(const slam::Slam& slam, Stamp stamp) {
  const ReflectionGrid filtered = map_.filtered();
  topics_.map(convert::to_occupancy(map_.occupancy(), stamp, map_frame_));
  topics_.map_filtered(convert::to_occupancy(filtered, stamp, map_frame_));
  topics_.reflection_filtered(convert::to_message(filtered));
  const bool have_moved = map_.take_moves();
  if (!have_moved && static_cast<double>(map_.scans()) < kLonger * static_cast<double>(told_poses_))
    return;
  told_poses_ = map_.scans();
  topics_.trajectory(to_path(slam, stamp, map_frame_));
}

}  // namespace strata::scan_matcher
