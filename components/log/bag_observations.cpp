// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_observations.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/set_back_clock.hpp"
#include "components/log/transform_tree.hpp"
#include "core/base/error.hpp"
#include "core/registration/sweep_timing.hpp"
#include "core/scan/undistort.hpp"

namespace strata::log {
namespace {

struct ScanStream {
  std::string frame;
  std::vector<Scan> scans;
};
struct OdometryStream {
  std::string frame;
  std::string child;
  std::vector<OdometrySample> samples;
};

bool is_finite(const Scan& scan) {
  return std::isfinite(scan.angle_min_rad) && std::isfinite(scan.angle_increment_rad) &&
         !std::isnan(scan.range_min_m) && !std::isnan(scan.range_max_m);
}

/// The topic to use of several with the same type.
template <typename Streams>
const typename Streams::value_type* choose(const Streams& streams, const std::string& wanted,
                                           const std::string& usual, const std::string& kind,
                                           ReadReport& report) {
  if (streams.empty()) return nullptr;
  if (!wanted.empty()) {
    const auto found = streams.find(wanted);
    return found == streams.end() ? nullptr : &*found;
  }
  const auto found = streams.find(usual);
  const auto& chosen = found != streams.end() ? *found : *streams.begin();
  if (streams.size() > 1) {
    report.warnings.push_back("of " + std::to_string(streams.size()) + " topics with " + kind +
                              " " + chosen.first + " is used");
  }
  return &chosen;
}

class BagParser {
 public:
  BagParser(const std::filesystem::path& path, const ReadOptions& options, ReadReport& report)
      : path_(path), options_(options), report_(report) {}

  LogContent read() {
    read_messages();
    const auto* scans = choose(scans_, options_.scan_topic, "/scan", "laser scans", report_);
    if (scans == nullptr) {
      throw InputError(report_.bad_lines > 0 ? report_.first_bad : path_.string(),
                       options_.scan_topic.empty()
                           ? "no sensor_msgs/msg/LaserScan can be read"
                           : "holds no readable scan on " + options_.scan_topic,
                       "see `strata info` for its topics");
    }
    report_.scan_topic = scans->first;
    LogContent content;
    content.scan_frame = scans->second.frame;
    content.robot_frame = options_.robot_frame;
    content.odom_frame = options_.odom_frame;
    OdometryTrack track(choose_odometry(content));
    const Pose3 mounting = find_mounting(content);
    add_observations(in_time(scans->second.scans), mounting, track, content);
    content.odometry = track.samples();
    return content;
  }

 private:
  void bad(const std::string& what) {
    if (report_.bad_lines++ == 0) report_.first_bad = what;
  }

  void read_messages() {
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
    report_.storage = reader->description();
    const BagDamage& damage = reader->damage();
    if (damage.count > 0) {
      if (report_.bad_lines == 0) report_.first_bad = damage.first;
      report_.bad_lines += damage.count;
      report_.warnings.push_back("the bag is damaged: " + damage.first);
    }
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
      OdometryStream& stream = odometry_[topic.name];
      stream.frame = frame_name(odometry.header().frame_id());
      stream.child = frame_name(odometry.child_frame_id());
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

  void take_scan(const std::string& topic, const sensor_msgs::msg::LaserScan& message,
                 const std::string& place) {
    Scan scan = convert::from_message(message, Pose2{});
    if (!is_finite(scan)) return bad(place + ": its angles or limits are not numbers");
    ScanStream& stream = scans_[topic];
    stream.frame = frame_name(message.header().frame_id());
    const auto& ranges = scan.ranges_m;
    if (std::all_of(ranges.begin(), ranges.end(), [](float r) { return std::isnan(r); })) {
      ++report_.scans_without_beams;
      return;
    }
    if (!stream.scans.empty() && scan.stamp < stream.scans.back().stamp) {
      ++report_.scans_out_of_order;
    }
    stream.scans.push_back(std::move(scan));
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
    const Pose3 pose = convert::from_message(transform.transform());
    if (!strata::is_finite(planar(pose))) return bad(place + ": a transform is not finite");
    if (is_static) {
      fixed_.add(parent, child, pose);
    } else if (parent == options_.odom_frame && options_.use_odometry) {
      OdometryStream& stream = moving_[child];
      stream.frame = parent;
      stream.child = child;
      add_sample(stream, convert::from_message(transform.header().stamp()), planar(pose), place);
    }
  }

  std::vector<Scan> in_time(std::vector<Scan> scans) {
    std::vector<Stamp> stamps;
    for (const Scan& scan : scans) stamps.push_back(scan.stamp);
    const SetBackClock clock = mend_set_back_clock(stamps, [&](std::size_t i, std::size_t j) {
      return scans[i].ranges_m == scans[j].ranges_m;
    });
    if (clock.times == 0) return scans;
    report_.warnings.push_back(clock.sentence());
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp = stamps[i];
    return scans;
  }

  std::vector<OdometrySample> choose_odometry(LogContent& content) {
    const auto* chosen = choose(odometry_, options_.odom_topic, "/odom", "odometry", report_);
    report_.odometry_source = "none";
    if (chosen == nullptr && !options_.odom_topic.empty()) {
      throw InputError(path_.string(), "holds no readable odometry on " + options_.odom_topic,
                       "see `strata info` for its topics");
    }
    if (chosen != nullptr) {
      report_.odometry_source = chosen->first;
    } else {
      chosen = choose(moving_, "", options_.robot_frame, "moving frames in tf", report_);
      if (chosen == nullptr) return {};
      report_.odometry_source = "tf";
    }
    const OdometryStream& stream = chosen->second;
    if (!stream.frame.empty()) content.odom_frame = stream.frame;
    if (!stream.child.empty()) content.robot_frame = stream.child;
    std::vector<OdometrySample> samples = stream.samples;
    mend_odometry_clock(samples);
    return samples;
  }

  Pose3 find_mounting(const LogContent& content) {
    report_.mounting_source = "tf_static";
    if (const auto found = fixed_.find(content.robot_frame, content.scan_frame)) return *found;
    report_.mounting_source = "assumed";
    report_.warnings.push_back("tf_static does not tie " + content.scan_frame + " to " +
                               content.robot_frame + "; the laser is taken to sit at its origin");
    return Pose3{};
  }

  void add_observations(std::vector<Scan> scans, const Pose3& mounting, const OdometryTrack& track,
                        LogContent& content) {
    for (Scan& scan : scans) {
      scan.robot_from_laser = planar(mounting);
      if (is_upside_down(mounting)) turn_over(scan);
    }
    std::stable_sort(scans.begin(), scans.end(),
                     [](const Scan& a, const Scan& b) { return a.stamp < b.stamp; });
    // Turning a scan over turned the order of its beams.
    report_.sweep = {.reversed = is_upside_down(mounting), .delay_s = 0.0};
    if (options_.undistort && !track.empty()) find_sweep_timing(scans, track);
    for (Scan& scan : scans) {
      Observation observation;
      observation.run = options_.run;
      observation.scan = std::move(scan);
      observation.has_odometry = !track.empty();
      if (!track.empty()) {
        const auto pose = odometry_at(track, observation.scan.stamp - delay());
        if (!pose) {
          ++report_.scans_without_odometry;
          continue;
        }
        observation.odom_from_robot = *pose;
      }
      if (options_.undistort) undistort_scan(observation, track);
      content.observations.push_back(std::move(observation));
    }
  }

  static void turn_over(Scan& scan) {
    const double last = scan.size() == 0 ? 0.0 : scan.bearing_rad(scan.size() - 1);
    std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
    scan.angle_min_rad = static_cast<float>(-last);
  }

  [[nodiscard]] std::optional<Pose2> odometry_at(const OdometryTrack& track, Stamp stamp) const {
    return track.at(stamp, options_.max_odometry_gap_s);
  }
  [[nodiscard]] Duration delay() const { return Duration::from_seconds(report_.sweep.delay_s); }

  void find_sweep_timing(const std::vector<Scan>& scans, const OdometryTrack& track) {
    const auto estimate = registration::estimate_sweep_timing(
        scans, [&](Stamp stamp) { return odometry_at(track, stamp); }, report_.sweep);
    if (!estimate.certain) return;
    const bool turned = estimate.timing.reversed != report_.sweep.reversed;
    report_.sweep = estimate.timing;
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << "the scans contradict their time stamps: beams "
         << (turned ? "are in the opposite order of time, " : "") << "begin "
         << std::abs(report_.sweep.delay_s) << " s "
         << (report_.sweep.delay_s >= 0.0 ? "before" : "after")
         << " the stamp by odometry's clock; corrected";
    report_.warnings.push_back(text.str());
  }

  void undistort_scan(Observation& observation, const OdometryTrack& track) {
    Scan& scan = observation.scan;
    const Duration sweep = sweep_duration(scan);
    if (observation.has_odometry && sweep.ns != 0) {
      const auto end = odometry_at(track, scan.stamp - delay() + sweep);
      if (end) {
        scan = undistort(scan, between(observation.odom_from_robot, *end), report_.sweep.reversed);
      }
    }
    scan.time_increment_s = 0.0F;
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  ReadReport& report_;
  std::map<std::string, ScanStream> scans_;
  std::map<std::string, OdometryStream> odometry_;
  std::map<std::string, OdometryStream> moving_;  ///< by child frame, from tf
  TransformTree fixed_;
};

}  // namespace

LogContent read_bag(const std::filesystem::path& path, const ReadOptions& options,
                    ReadReport& report) {
  return BagParser(path, options, report).read();
}

}  // namespace strata::log
