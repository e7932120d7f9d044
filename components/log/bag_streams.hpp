// SPDX-License-Identifier: Apache-2.0
/// What a bag holds of scans, odometry and frames, topic by topic, before any of it is joined.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "components/log/log_reader.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/robot_frames.hpp"
#include "core/scan/scan.hpp"

namespace strata::log {

/// A scan as it was recorded.
struct FramedScan {
  std::string frame;
  Scan scan;
};
using ScanStream = std::vector<FramedScan>;
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

/// Reads the whole bag. What cannot be used is counted in the report, and the first of it named.
[[nodiscard]] BagStreams read_bag_streams(const std::filesystem::path& path,
                                          const ReadOptions& options, ReadReport& report);

}  // namespace strata::log
