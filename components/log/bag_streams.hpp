// SPDX-License-Identifier: Apache-2.0
/// What a bag holds of scans, odometry and frames, topic by topic, before any of it is joined.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "components/log/joined_scan.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/robot_frames.hpp"

namespace strata::log {

/// In the order of recording.
using ScanStream = std::vector<SensedScan>;
/// In the order of recording.
struct OdometryStream {
  std::string frame;
  std::string child;
  std::vector<OdometrySample> samples;
};

struct BagStreams {
  std::map<std::string, ScanStream> scans;         ///< by topic
  std::map<std::string, OdometryStream> odometry;  ///< by topic
  std::map<std::string, OdometryStream> moving;    ///< from tf, by child of the odometry frame
  RobotFrames frames;
};

/// Reads the whole bag but for its clouds. What cannot be used is counted in the report, and the
/// first of it named.
[[nodiscard]] BagStreams read_bag_streams(const std::filesystem::path& path,
                                          const ReadOptions& options, ReadReport& report);

/// Mounts a cloud, so that only its slice has to be kept.
using MountCloud = std::function<void(SensedScan&)>;
/// The clouds of a topic, mounted. Reads the whole bag again. Blank ones are counted as scans
/// without beams.
[[nodiscard]] ScanStream read_bag_clouds_as_scans(const std::filesystem::path& path,
                                                  const std::string& topic,
                                                  const MountCloud& mount_cloud,
                                                  ReadReport& report);

inline constexpr const char* kCloudType = "sensor_msgs/msg/PointCloud2";

}  // namespace strata::log
