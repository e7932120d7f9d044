// SPDX-License-Identifier: Apache-2.0
/// What another project's localizer is given, and what it answers: JSON between two processes, so
/// that nothing of a peer is linked into strata.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/geometry/pose2.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::peers {

/// A map_server map: rows from the lowest y, cells as kFree and so on.
struct PeerMap {
  static constexpr int kFree = 0;
  static constexpr int kOccupied = 1;
  static constexpr int kUnknown = 2;
  double resolution_m = 0.05;
  double origin_x_m = 0.0;  ///< of the lower left corner
  double origin_y_m = 0.0;
  int width = 0;
  std::vector<int> cells;
};
[[nodiscard]] PeerMap peer_map(const ReflectionGrid& map);

/// One scan: metres counter-clockwise, NaN where there is no return.
struct PeerScan {
  Pose2 odom_from_robot;
  Pose2 robot_from_laser;
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  double range_max_m = 0.0;
  std::vector<double> ranges_m;
  std::optional<Pose2> truth;  ///< map_from_robot: for the error only
};
[[nodiscard]] PeerScan peer_scan(const Observation& observation, const std::optional<Pose2>& truth);

struct PeerJob {
  PeerMap map;
  std::vector<PeerScan> scans;
  Pose2Gaussian start;
  std::uint64_t seed = 1;
  std::size_t particles = 1000;
};

/// One entry a scan; errors only for those whose truth is known.
struct PeerResult {
  std::vector<std::optional<double>> errors_m;
  std::vector<std::optional<double>> errors_rad;
  std::vector<Pose2> estimates;
  std::vector<double> update_ms;
};

[[nodiscard]] nlohmann::json to_json(const PeerJob& job);
[[nodiscard]] PeerJob job_from_json(const nlohmann::json& json);
[[nodiscard]] nlohmann::json to_json(const PeerResult& result);
/// Throws InputError when it is not the answer to a job of so many scans.
[[nodiscard]] PeerResult result_from_json(const nlohmann::json& json, std::size_t scans);

/// Has a peer's program work on a job, given and answered in files below `folder`. Throws Error
/// when it fails.
[[nodiscard]] PeerResult run_peer(const std::filesystem::path& program, const PeerJob& job,
                                  const std::filesystem::path& folder);

}  // namespace strata::peers
