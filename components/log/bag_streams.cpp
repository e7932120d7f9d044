// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_streams.hpp"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

/// Unless it is blank; counts what is wrong with it.
void append(SensedScan scan, ScanStream& stream, ReadReport& report) {
  if (is_blank(scan.scan)) {
    ++report.scans_without_beams;
    return;
  }
  if (!stream.empty() && scan.scan.stamp < stream.back().scan.stamp) ++report.scans_out_of_order;
  stream.push_back(std::move(scan));
}

/// Simulators publish the truth in the form of odometry, `/base_pose_ground_truth`.
bool says_truth(const std::string& topic) {
  return topic.find("ground_truth") != std::string::npos ||
         topic.find("groundtruth") != std::string::npos;
}

class StreamReader {
 public:
  StreamReader(const std::filesystem::path& path, const ReadOptions& options, ReadReport& report)
      : path_(path),
        options_(options),
        report_(report),
        streams_{{}, {}, {}, RobotFrames(options.robot_frame)} {}

  BagStreams read() {
    const auto reader = BagReader::open(path_);
    BagMessage message;
    std::size_t done = 0;
    while (reader->next(message)) {
      const BagTopic& topic = reader->topics()[message.topic];
      ++report_.messages[topic.name];
      report_.types[topic.name] = topic.type;
      try {
        if (topic.serialization_format == "cdr") take(topic, message);
      } catch (const InputError& error) {
        bad(error.what());
      }
      if (++done % 1000 == 0) report_progress(options_.progress, "read log", done, 0);
    }
    leave_out_truth();
    if (streams_.moving.empty()) take_other_odometry_frame();
    report_.storage = reader->description();
    const BagDamage& damage = reader->damage();
    if (damage.count > 0) {
      if (report_.bad_lines == 0) report_.first_bad = damage.first;
      report_.bad_lines += damage.count;
      report_.warnings.push_back("the bag is damaged: " + damage.first);
    }
    if (unset_rotations_ > 0) {
      report_.warnings.push_back(
          std::to_string(unset_rotations_) +
          " poses of the odometry have a quaternion of zeros, which is taken for no turn");
    }
    return std::move(streams_);
  }

 private:
  void bad(const std::string& what) {
    if (report_.bad_lines++ == 0) report_.first_bad = what;
  }

  void take(const BagTopic& topic, const BagMessage& message) {
    const auto place = [&] {
      return path_.string() + ": " + topic.name + " message " +
             std::to_string(report_.messages[topic.name]);
    };
    if (topic.type == "sensor_msgs/msg/LaserScan") {
      const auto scan = convert::from_cdr<sensor_msgs::msg::LaserScan>(message.data, place());
      take_scan(topic.name, scan, place());
    } else if (topic.type == "nav_msgs/msg/Odometry" && options_.use_odometry) {
      const auto odometry = convert::from_cdr<nav_msgs::msg::Odometry>(message.data, place());
      OdometryStream& stream = streams_.odometry[topic.name];
      stream.frame = frame_name(odometry.header().frame_id());
      stream.child = frame_name(odometry.child_frame_id());
      note_rotation(odometry.pose().pose().orientation());
      add_sample(stream, convert::from_message(odometry.header().stamp()),
                 planar(convert::from_message(odometry.pose().pose())), place());
    } else if (topic.type == "tf2_msgs/msg/TFMessage") {
      const auto transforms = convert::from_cdr<tf2_msgs::msg::TFMessage>(message.data, place());
      const bool is_static = topic.name.find("tf_static") != std::string::npos;
      for (const auto& transform : transforms.transforms()) {
        take_transform(transform, is_static, place());
      }
    }
  }

  void note_rotation(const geometry_msgs::msg::Quaternion& q) {
    if (q.x() == 0.0 && q.y() == 0.0 && q.z() == 0.0 && q.w() == 0.0) ++unset_rotations_;
  }

  void take_scan(const std::string& topic, const sensor_msgs::msg::LaserScan& message,
                 const std::string& place) {
    SensedScan framed = sensed(message, place);
    const std::string doubt = doubt_angles(message);
    if (!doubt.empty() && doubted_.insert(topic).second) {
      report_.warnings.push_back(place + ": " + doubt);
    }
    append(std::move(framed), streams_.scans[topic], report_);
  }

  void add_sample(OdometryStream& stream, Stamp stamp, const Pose2& pose,
                  const std::string& place) {
    if (!strata::is_finite(pose)) return bad(place + ": its pose is not finite");
    stream.samples.push_back({stamp, pose});
  }

  void take_transform(const geometry_msgs::msg::TransformStamped& transform, bool is_static,
                      const std::string& place) {
    const std::string parent = frame_name(transform.header().frame_id());
    const std::string child = frame_name(transform.child_frame_id());
    const auto not_finite = [&] {
      bad(place + ": the transform of " + child + " in " + parent + " is not finite");
    };
    if (is_static) {
      if (!streams_.frames.add_fixed(transform)) not_finite();
    } else if (parent != frame_name(options_.odom_frame)) {
      if (!streams_.frames.add_moving(transform)) return not_finite();
      if (options_.use_odometry && names_odometry(parent)) {
        add_moving(transform, other_odometry_[parent][child]);
      }
    } else if (options_.use_odometry) {
      if (!is_sound(convert::from_message(transform.transform()))) return not_finite();
      note_rotation(transform.transform().rotation());
      add_moving(transform, streams_.moving[child]);
    }
  }

  /// Unless it is named.
  void leave_out_truth() {
    for (auto stream = streams_.odometry.begin(); stream != streams_.odometry.end();) {
      if (!says_truth(stream->first) || stream->first == options_.odom_topic) {
        ++stream;
        continue;
      }
      report_.warnings.push_back(stream->first +
                                 " is the truth by its name, and not taken for odometry (--truth " +
                                 path_.string() + ":" + stream->first + " compares with it)");
      stream = streams_.odometry.erase(stream);
    }
  }

  static void add_moving(const geometry_msgs::msg::TransformStamped& transform,
                         OdometryStream& stream) {
    stream.frame = frame_name(transform.header().frame_id());
    stream.child = frame_name(transform.child_frame_id());
    stream.samples.push_back({convert::from_message(transform.header().stamp()),
                              planar(convert::from_message(transform.transform()))});
  }

  /// Robots of ROS 1 have odom_combined and the like.
  void take_other_odometry_frame() {
    if (other_odometry_.empty()) return;
    streams_.moving = std::move(other_odometry_.begin()->second);
    if (other_odometry_.size() > 1 && streams_.odometry.empty()) {
      report_.warnings.push_back("of " + std::to_string(other_odometry_.size()) +
                                 " frames of odometry " + other_odometry_.begin()->first +
                                 " is used");
    }
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  ReadReport& report_;
  BagStreams streams_;
  /// By frame: moving in one that is not called as options_ has it, but is named so.
  std::map<std::string, std::map<std::string, OdometryStream>> other_odometry_;
  std::size_t unset_rotations_ = 0;
  std::set<std::string> doubted_;  ///< topics whose angles are
};

}  // namespace

BagStreams read_bag_streams(const std::filesystem::path& path, const ReadOptions& options,
                            ReadReport& report) {
  return StreamReader(path, options, report).read();
}

ScanStream read_bag_clouds_as_scans(const std::filesystem::path& path, const std::string& topic,
                                    const MountCloud& mount_cloud, ReadReport& report) {
  ScanStream stream;
  const auto reader = BagReader::open(path);
  BagMessage message;
  std::size_t count = 0;
  while (reader->next(message)) {
    if (reader->topics()[message.topic].name != topic) continue;
    const std::string place = path.string() + ": " + topic + " message " + std::to_string(++count);
    try {
      SensedScan cloud =
          sensed(convert::from_cdr<sensor_msgs::msg::PointCloud2>(message.data, place));
      mount_cloud(cloud);
      append(std::move(cloud), stream, report);
    } catch (const InputError& error) {
      if (report.bad_lines++ == 0) report.first_bad = place + ": " + error.what();
    }
  }
  return stream;
}

}  // namespace strata::log
