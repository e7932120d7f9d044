// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_observations.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "components/log/bag_streams.hpp"
#include "components/log/equal_stamps.hpp"
#include "components/log/joined_scan.hpp"
#include "components/log/no_return_limit.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/set_back_clock.hpp"
#include "core/base/error.hpp"
#include "core/registration/sweep_timing.hpp"
#include "core/scan/range_limit.hpp"

namespace strata::log {
namespace {

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
    streams_ = read_bag_streams(path_, options_, report_);
    const std::vector<std::string> topics = choose_scans();
    LogContent content;
    content.odom_frame = options_.odom_frame;
    const OdometryTrack track(choose_odometry(content));
    content.robot_frame = streams_.frames.pose_frame(odometry_child_);
    report_.mounting_source = "tf_static";
    for (const std::string& topic : topics) {
      if (report_.types[topic] == kCloudType) read_clouds(topic);
      report_.scan_topic += (report_.scan_topic.empty() ? "" : ", ") + topic;
      add_scans(topic, topics.size() > 1 ? topic + ": " : "", track, content);
    }
    std::stable_sort(content.observations.begin(), content.observations.end(),
                     [](const auto& a, const auto& b) { return a.scan.stamp < b.scan.stamp; });
    content.odometry = track.samples();
    for (OdometrySample& sample : content.odometry) {
      sample.odom_from_robot =
          moved_by(sample.odom_from_robot, streams_.frames.robot_in(odometry_child_));
    }
    return content;
  }

 private:
  std::vector<std::string> choose_scans() {
    std::vector<std::string> wanted = options_.scan_topics;
    if (wanted.empty()) wanted.push_back(options_.scan_topic);
    std::vector<std::string> topics;
    for (const std::string& name : wanted) {
      const auto type = report_.types.find(name);
      if (type != report_.types.end() && type->second == kCloudType) {
        topics.push_back(name);
        continue;
      }
      const auto* scans = choose(streams_.scans, name, "/scan", "laser scans", report_);
      if (scans == nullptr) throw_no_scan(name);
      topics.push_back(scans->first);
    }
    return topics;
  }

  [[noreturn]] void throw_no_scan(const std::string& topic) const {
    const bool has_clouds =
        std::any_of(report_.types.begin(), report_.types.end(),
                    [](const auto& entry) { return entry.second == kCloudType; });
    throw InputError(report_.bad_lines > 0 ? report_.first_bad : path_.string(),
                     topic.empty() ? "no sensor_msgs/msg/LaserScan can be read"
                                   : "holds no readable scan on " + topic,
                     has_clouds ? "name the topic of its clouds, --scan-topic, to have slices of "
                                  "them taken for scans"
                                : "see `strata info` for its topics");
  }

  void read_clouds(const std::string& topic) {
    streams_.scans[topic] = read_bag_clouds_as_scans(
        path_, topic,
        [this](SensedScan& cloud) { mount(cloud, find_mounting(cloud.frame), options_.cloud); },
        report_);
  }

  void mend_clock(ScanStream& scans, const std::string& where) {
    std::vector<Stamp> stamps;
    for (const SensedScan& framed : scans) stamps.push_back(framed.scan.stamp);
    const SetBackClock clock = mend_set_back_clock(stamps, [&](std::size_t i, std::size_t j) {
      return scans[i].scan.ranges_m == scans[j].scan.ranges_m;
    });
    if (clock.times == 0) return;
    report_.warnings.push_back(where + clock.sentence());
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].scan.stamp = stamps[i];
  }

  /// The robot's own of the frames that move in the odometry frame.
  const std::pair<const std::string, OdometryStream>* choose_moving() {
    const auto own = streams_.moving.find(frame_name(options_.robot_frame));
    if (own != streams_.moving.end()) return &*own;
    for (const auto& stream : streams_.moving) {
      if (streams_.frames.is_robots(stream.first)) return &stream;
    }
    return choose(streams_.moving, "", "", "moving frames in tf", report_);
  }

  std::vector<OdometrySample> choose_odometry(LogContent& content) {
    const auto* chosen =
        choose(streams_.odometry, options_.odom_topic, "/odom", "odometry", report_);
    report_.odometry_source = "none";
    if (chosen == nullptr && !options_.odom_topic.empty()) {
      throw InputError(path_.string(), "holds no readable odometry on " + options_.odom_topic,
                       "see `strata info` for its topics");
    }
    if (chosen != nullptr) {
      report_.odometry_source = chosen->first;
    } else {
      chosen = choose_moving();
      if (chosen == nullptr) return {};
      report_.odometry_source = "tf";
    }
    const OdometryStream& stream = chosen->second;
    if (!stream.frame.empty()) content.odom_frame = stream.frame;
    odometry_child_ = stream.child;
    std::vector<OdometrySample> samples = stream.samples;
    mend_odometry_clock(samples);
    const Duration lag = Duration::from_seconds(options_.odometry_lag_s.value_or(0.0));
    for (OdometrySample& sample : samples) sample.stamp = sample.stamp - lag;
    return samples;
  }

  Pose3 find_mounting(const std::string& frame) {
    if (const auto found = streams_.frames.mounting(frame, odometry_child_)) {
      const bool is_fixed = streams_.frames.is_fixed(frame, odometry_child_);
      if (!is_fixed && report_.mounting_source != "assumed") report_.mounting_source = "tf";
      return *found;
    }
    if (!assumed_.insert(frame).second) return Pose3{};
    report_.mounting_source = "assumed";
    report_.warnings.push_back(streams_.frames.missing_mounting(frame, odometry_child_));
    return Pose3{};
  }

  /// The scans of a topic, one frame after the other.
  void add_scans(const std::string& topic, const std::string& where, const OdometryTrack& track,
                 LogContent& content) {
    ScanStream& stream = streams_.scans[topic];
    mend_clock(stream, where);
    std::vector<std::string> frames;
    for (const SensedScan& framed : stream) {
      if (std::find(frames.begin(), frames.end(), framed.frame) == frames.end()) {
        frames.push_back(framed.frame);
      }
    }
    for (const std::string& frame : frames) {
      ScanStream scans;
      for (SensedScan& framed : stream) {
        if (framed.frame == frame) scans.push_back(std::move(framed));
      }
      if (scanners_ == 0) content.scan_frame = frame;
      report_.scanners.push_back({topic, {}});
      const Pose3 mounting = find_mounting(frame);
      const std::string doubt = doubt_mounting(frame, mounting);
      const bool is_cloud = scans.front().is_cloud;
      if (!is_cloud && !doubt.empty()) report_.warnings.push_back(doubt);
      // The slice of a cloud lies elsewhere than the cloud's own frame.
      if (!is_cloud) content.scanner_frames.push_back({planar(mounting), frame});
      add_observations(std::move(scans), mounting, where, track, content);
      ++scanners_;
    }
  }

  void add_observations(ScanStream scans, const Pose3& mounting, const std::string& where,
                        const OdometryTrack& track, LogContent& content) {
    for (SensedScan& framed : scans) {
      if (!framed.is_cloud) mount(framed, mounting, options_.cloud);
    }
    report_.scanners.back().robot_from_laser = scans.front().scan.robot_from_laser;
    std::stable_sort(scans.begin(), scans.end(),
                     [](const auto& a, const auto& b) { return a.scan.stamp < b.scan.stamp; });
    note_equal_stamps(
        scans, [](const SensedScan& framed) { return framed.scan.stamp; }, where, report_);
    const Pose2 child_from_robot = streams_.frames.robot_in(odometry_child_);
    OdometryAt odometry;
    if (!track.empty()) {
      odometry = [&](Stamp stamp) -> std::optional<Pose2> {
        const auto pose = track.at(stamp, options_.max_odometry_gap_s);
        return pose ? std::optional(moved_by(*pose, child_from_robot)) : std::nullopt;
      };
    }
    // Turning a scan over turned the order of its beams.
    SweepTiming sweep{.reversed = is_upside_down(mounting), .delay_s = 0.0};
    if (options_.undistort && odometry && !scans.front().is_cloud) {
      sweep = find_sweep_timing(scans, odometry, sweep, where);
    }
    if (scanners_ == 0) report_.sweep = sweep;
    if (!scans.front().is_cloud) settle_ranges(scans, where, odometry, sweep);
    for (SensedScan& framed : scans) {
      auto observation = join(std::move(framed), odometry, sweep, options_.undistort);
      if (!observation) {
        ++report_.scans_without_odometry;
        continue;
      }
      observation->run = options_.run;
      content.observations.push_back(std::move(*observation));
    }
  }

  /// Before the scans are undistorted, which would spread a code over several readings.
  void settle_ranges(ScanStream& scans, const std::string& where, const OdometryAt& odometry,
                     const SweepTiming& sweep) {
    std::vector<RangedScan> ranged;
    for (SensedScan& framed : scans) {
      const Stamp begin = framed.scan.stamp - Duration::from_seconds(sweep.delay_s);
      const auto pose = odometry ? odometry(begin) : std::nullopt;
      ranged.push_back({&framed.scan, pose.value_or(Pose2{})});
    }
    const bool is_stated = tells_reach(scans.front().scan.range_max_m);
    settle_no_returns(ranged, where.empty() ? "" : where.substr(0, where.size() - 2),
                      is_stated ? "range_max of its messages"
                                : "no scanner in the plane sees further; range_max is not stated",
                      options_, report_);
  }

  SweepTiming find_sweep_timing(ScanStream& stream, const OdometryAt& odometry,
                                const SweepTiming& stated, const std::string& where) {
    std::vector<Scan> scans;
    for (SensedScan& framed : stream) scans.push_back(std::move(framed.scan));
    const auto estimate = registration::estimate_sweep_timing(scans, odometry, stated);
    for (std::size_t i = 0; i < scans.size(); ++i) stream[i].scan = std::move(scans[i]);
    if (!estimate.certain) return stated;
    const SweepTiming& found = estimate.timing;
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << where
         << "the scans contradict their time stamps: beams "
         << (found.reversed != stated.reversed ? "are in the opposite order of time, " : "")
         << "begin " << std::abs(found.delay_s) << " s "
         << (found.delay_s >= 0.0 ? "before" : "after")
         << " the stamp by odometry's clock; corrected";
    report_.warnings.push_back(text.str());
    return found;
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  ReadReport& report_;
  BagStreams streams_;
  std::string odometry_child_;
  std::set<std::string> assumed_;  ///< frames without a mounting
  int scanners_ = 0;
};

}  // namespace

LogContent read_bag(const std::filesystem::path& path, const ReadOptions& options,
                    ReadReport& report) {
  return BagParser(path, options, report).read();
}

}  // namespace strata::log
