// SPDX-License-Identifier: Apache-2.0
#include "tests/across/every_component/good_messages.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "components/bus/message_types.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/message_definitions.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/log_writer.hpp"
#include "components/maps/node_map_message.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double kHalfWidth_m = 3.0;
constexpr double kHalfDepth_m = 2.0;
constexpr int kBeams = 180;

Stamp stamp_of(int step) { return {1'700'000'000'000'000'000 + step * 100'000'000LL}; }

/// Around in the middle of the room, 0.1 m a step.
Pose2 pose_of(int step) {
  const double angle = 0.1 * step;
  return {std::cos(angle) - 1.0, std::sin(angle), angle + std::numbers::pi / 2.0};
}

float range_m(const Pose2& robot, double bearing_rad) {
  const double c = std::cos(robot.theta + bearing_rad);
  const double s = std::sin(robot.theta + bearing_rad);
  const double to_x = ((c > 0.0 ? kHalfWidth_m : -kHalfWidth_m) - robot.x) / c;
  const double to_y = ((s > 0.0 ? kHalfDepth_m : -kHalfDepth_m) - robot.y) / s;
  return static_cast<float>(std::min(std::abs(to_x), std::abs(to_y)));
}

Scan scan_of(int step) {
  Scan scan;
  scan.stamp = stamp_of(step);
  scan.angle_min_rad = -1.57F;
  scan.angle_increment_rad = 3.14F / kBeams;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 20.0F;
  for (int beam = 0; beam < kBeams; ++beam) {
    scan.ranges_m.push_back(
        range_m(pose_of(step), scan.bearing_rad(static_cast<std::size_t>(beam))));
  }
  return scan;
}

PosedScan posed_scan(int step) {
  return {0, scan_of(step), pose_of(step), std::vector<float>(kBeams, 0.9F)};
}

patch::PatchMap patch_map() {
  patch::PatchMap map;
  map.base = room_map();
  patch::Submap submap;
  submap.rect = {{-10, -10}, {10, 10}};
  submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect, 1);
  for (const double prior : {0.75, 0.25}) {
    patch::Configuration configuration;
    configuration.counts = Grid<CellCounts>(0.05, submap.rect, CellCounts{1.0, 3.0});
    configuration.reflection = make_reflection_grid(0.05, submap.rect);
    std::fill(configuration.reflection.values().begin(), configuration.reflection.values().end(),
              static_cast<float>(prior));
    configuration.prior = prior;
    submap.configurations.push_back(configuration);
  }
  submap.sequences.push_back({0, stamp_of(0), stamp_of(9), 10, {0.75, 0.25}});
  map.submaps.push_back(submap);
  return map;
}

Bytes node_map(int step) {
  memory::TimescaleMemory memory({}, 1);
  for (int i = 0; i < 5; ++i) (void)memory.observe(posed_scan(i), nullptr, 0);
  const auto decoded = memory.decode({}, nullptr, 0.0, 50);
  return convert::to_cdr(maps::to_message(memory, *decoded, stamp_of(step), "map"));
}

Bytes transforms(const std::string& topic, int step) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      topic.ends_with("static")
          ? convert::to_transform_stamped(stamp_of(step), Pose2(), "base_link", "laser")
          : convert::to_transform_stamped(stamp_of(step), pose_of(step), "odom", "base_link"));
  message.transforms().push_back(
      convert::to_transform_stamped(stamp_of(step), Pose2(), "map", "odom"));
  return convert::to_cdr(message);
}

Bytes cloud(int step) {
  std::vector<Eigen::Vector3f> points;
  const Scan scan = scan_of(step);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const auto bearing = static_cast<float>(scan.bearing_rad(i));
    points.emplace_back(scan.ranges_m[i] * std::cos(bearing), scan.ranges_m[i] * std::sin(bearing),
                        0.1F);
  }
  convert::CloudColumns columns;
  columns.offset_s.assign(points.size(), 0.01F);
  return convert::to_cdr(convert::to_message(points, scan.stamp, "laser", columns));
}

Bytes scan_pose(int step) {
  strata_msgs::msg::ScanPose message;
  message.header(convert::make_header(stamp_of(step), "map"));
  message.index(static_cast<std::uint64_t>(step));
  message.map_from_robot(convert::to_message(Pose2Gaussian{pose_of(step), {}}));
  message.odom_from_robot(convert::to_message(pose_of(step)));
  message.has_odometry(true);
  return convert::to_cdr(message);
}

Bytes initial_pose(int step) {
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  message.header(convert::make_header(stamp_of(step), "map"));
  message.pose(convert::to_pose_with_covariance({pose_of(step), Eigen::Matrix3d::Identity()}));
  return convert::to_cdr(message);
}

Bytes landmark(int step) {
  geometry_msgs::msg::PointStamped message;
  message.header(convert::make_header(stamp_of(step), "map"));
  return convert::to_cdr(message);
}

Bytes clock(int step) {
  rosgraph_msgs::msg::Clock message;
  message.clock(convert::to_message(stamp_of(step)));
  return convert::to_cdr(message);
}

/// Of the posed scans so far, each a little aside of where it came.
Bytes trajectory(int step) {
  nav_msgs::msg::Path path;
  path.header(convert::make_header(stamp_of(step), "map"));
  for (int s = 0; s <= step; ++s) {
    const PosedScan scan = posed_scan(s);
    geometry_msgs::msg::PoseStamped pose;
    pose.header(convert::make_header(scan.scan.stamp, "map"));
    pose.pose(convert::to_pose(Pose2{0.1, 0.0, 0.0} * scan.map_from_robot));
    path.poses().push_back(pose);
  }
  return convert::to_cdr(path);
}

/// Writes what the IDL says, little-endian.
class Plain {
 public:
  [[nodiscard]] Bytes of(const convert::MessageLayout& layout) {
    bytes_ = {0, 1, 0, 0};
    message(layout);
    return bytes_;
  }

 private:
  void message(const convert::MessageLayout& layout) {
    for (const auto& field : layout.fields) {
      const std::size_t count = field.is_sequence ? 2 : field.count;
      if (field.is_sequence) number(2);
      for (std::size_t i = 0; i < count; ++i) {
        if (field.part != nullptr) {
          message(*field.part);
        } else if (field.size > 0) {
          align(field.size);
          bytes_.insert(bytes_.end(), field.size, 0);
        } else {
          number(2);
          bytes_.insert(bytes_.end(), {'a', 0});
        }
      }
    }
  }
  void number(std::uint8_t value) {
    align(4);
    bytes_.insert(bytes_.end(), {value, 0, 0, 0});
  }
  void align(std::size_t size) {
    while ((bytes_.size() - 4) % size != 0) bytes_.push_back(0);
  }
  Bytes bytes_;
};

}  // namespace

ReflectionGrid room_map() {
  ReflectionGrid map = make_reflection_grid(0.05, {{-62, -42}, {62, 42}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.cell(i);
    const bool is_wall = cell.x < -60 || cell.x >= 60 || cell.y < -40 || cell.y >= 40;
    map.values()[i] = is_wall ? 1.0F : 0.0F;
  }
  return map;
}

std::filesystem::path written_log(const std::filesystem::path& folder) {
  const std::filesystem::path bag = folder / "drive";
  if (std::filesystem::exists(bag)) return bag;
  log::LogContent content;
  for (int step = 0; step < 20; ++step) {
    content.observations.push_back({0, scan_of(step), pose_of(step), true});
  }
  log::write_bag(bag, content, log::BagStorage::kMcap);
  return bag;
}

std::vector<std::uint8_t> good_message(const std::string& type, const std::string& topic,
                                       int step) {
  static const std::map<std::string, std::function<Bytes(const std::string&, int)>> known = {
      {"sensor_msgs/msg/LaserScan",
       [](const auto&, int s) {
         return convert::to_cdr(convert::to_message(scan_of(s), "laser"));
       }},
      {"nav_msgs/msg/Odometry",
       [](const auto&, int s) {
         return convert::to_cdr(convert::to_odometry(stamp_of(s), pose_of(s), "odom", "base_link"));
       }},
      {"nav_msgs/msg/Path", [](const auto&, int s) { return trajectory(s); }},
      {"tf2_msgs/msg/TFMessage", transforms},
      {"sensor_msgs/msg/PointCloud2", [](const auto&, int s) { return cloud(s); }},
      {"strata_msgs/msg/LabeledScan",
       [](const auto&, int s) {
         return convert::to_cdr(convert::to_message(posed_scan(s), "map", "laser"));
       }},
      {"strata_msgs/msg/ReflectionGrid",
       [](const auto&, int) { return convert::to_cdr(convert::to_message(room_map())); }},
      {"nav_msgs/msg/OccupancyGrid",
       [](const auto&, int s) {
         return convert::to_cdr(convert::to_occupancy(room_map(), stamp_of(s), "map"));
       }},
      {"strata_msgs/msg/PatchMap",
       [](const auto&, int s) {
         return convert::to_cdr(convert::to_message(patch_map(), stamp_of(s), "map"));
       }},
      {"strata_msgs/msg/NodeMap", [](const auto&, int s) { return node_map(s); }},
      {"strata_msgs/msg/ScanPose", [](const auto&, int s) { return scan_pose(s); }},
      {"geometry_msgs/msg/PoseWithCovarianceStamped",
       [](const auto&, int s) { return initial_pose(s); }},
      {"geometry_msgs/msg/PointStamped", [](const auto&, int s) { return landmark(s); }},
      {"rosgraph_msgs/msg/Clock", [](const auto&, int s) { return clock(s); }},
  };
  if (const auto found = known.find(type); found != known.end()) return found->second(topic, step);
  const convert::MessageLayout* layout = convert::message_layout(type);
  return layout == nullptr ? Bytes{0, 1, 0, 0} : Plain().of(*layout);
}

}  // namespace strata::test
