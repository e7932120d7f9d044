// SPDX-License-Identifier: Apache-2.0
/// learn_from_scans LOG MAP.yaml: where a recorded robot drove, one TUM line a scan, and the map of
/// what stands still there, as map_server and nav2 read it.
///
/// LOG is a CARMEN log, a rosbag2 folder, .db3, .mcap or ROS 1 .bag.
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include <strata/base/error.hpp>
#include <strata/log/log_reader.hpp>
#include <strata/log/map_file.hpp>
#include <strata/slam/slam.hpp>

void learn(const std::filesystem::path& log, const std::filesystem::path& map) {
  strata::slam::Slam slam({}, /*threads=*/0);
  for (const strata::Observation& seen : strata::log::read_observations(log)) slam.add(seen);
  const strata::slam::SlamResult result = slam.finish();
  for (const std::string& warning : result.warnings) {
    std::fprintf(stderr, "learn_from_scans: warning: %s\n", warning.c_str());
  }
  for (const strata::PosedScan& posed : result.scans) {
    const strata::Pose2& pose = posed.map_from_robot;
    std::printf("%.9f %.9f %.9f 0 0 0 %.9f %.9f\n", posed.scan.stamp.seconds(), pose.x, pose.y,
                std::sin(pose.theta / 2), std::cos(pose.theta / 2));
  }
  strata::log::write_map(map, result.filtered);
}

int main(int argc, char** argv) try {
  if (argc != 3) {
    throw strata::InputError("command line", "is not complete", "give LOG MAP.yaml");
  }
  learn(argv[1], argv[2]);
  return 0;
} catch (const strata::InputError& error) {
  std::fprintf(stderr, "learn_from_scans: error: %s\n", error.what());
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "learn_from_scans: error: %s\n", error.what());
  return 1;
}
