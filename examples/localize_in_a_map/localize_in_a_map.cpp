// SPDX-License-Identifier: Apache-2.0
/// localize_in_a_map MAP LOG [X Y THETA]: where a recorded robot was, one TUM line a scan.
///
/// MAP is a folder that `strata learn` wrote, or the YAML file of a map_server map. LOG is a CARMEN
/// log, a rosbag2 folder, .db3, .mcap or ROS 1 .bag. X Y THETA is where the robot starts in the
/// map, in metres and radians; without it the robot is looked for everywhere.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>

#include <strata/base/error.hpp>
#include <strata/localization/localizer.hpp>
#include <strata/log/log_reader.hpp>
#include <strata/log/map_file.hpp>
#include <strata/maps/map_model.hpp>

void localize(const std::filesystem::path& map, const std::filesystem::path& log,
              const std::optional<strata::Pose2>& start) {
  strata::maps::Maps maps;
  if (is_directory(map)) {
    maps = strata::maps::read_maps(map);
  } else {
    maps.filtered = strata::log::read_map(map);
  }
  const auto model = strata::maps::make_map_model(maps, maps.patches ? "patch" : "filtered", {});
  strata::localization::Localizer localizer({}, model.sensor, /*seed=*/1);
  if (start) {
    localizer.initialize({*start, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
  } else {
    localizer.initialize_global(maps.filtered);
  }
  for (const strata::Observation& seen : strata::log::read_observations(log)) {
    const strata::Pose2 pose = localizer.update(seen).pose.mean;
    std::printf("%.9f %.9f %.9f 0 0 0 %.9f %.9f\n", seen.scan.stamp.seconds(), pose.x, pose.y,
                std::sin(pose.theta / 2), std::cos(pose.theta / 2));
  }
}

double number(const char* text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end != text && *end == '\0') return value;
  throw strata::InputError(text, "is no number", "give X and Y in metres, THETA in radians");
}

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 6) {
    throw strata::InputError("command line", "is not complete", "give MAP LOG [X Y THETA]");
  }
  std::optional<strata::Pose2> start;
  if (argc == 6) start = {number(argv[3]), number(argv[4]), number(argv[5])};
  localize(argv[1], argv[2], start);
  return 0;
} catch (const strata::InputError& error) {
  std::fprintf(stderr, "localize_in_a_map: error: %s\n", error.what());
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "localize_in_a_map: error: %s\n", error.what());
  return 1;
}
