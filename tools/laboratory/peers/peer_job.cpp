// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/peers/peer_job.hpp"

#include <cmath>
#include <limits>

#include "core/base/error.hpp"

namespace strata::peers {
namespace {

using nlohmann::json;

json to_json(const Pose2& pose) { return {pose.x, pose.y, pose.theta}; }

Pose2 pose_from(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

json to_json(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

std::optional<double> number_from(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

json to_json(const PeerScan& scan) {
  json ranges = json::array();
  for (const double range_m : scan.ranges_m) {
    ranges.push_back(to_json(std::isnan(range_m) ? std::nullopt : std::optional(range_m)));
  }
  return {{"odom", to_json(scan.odom_from_robot)},
          {"laser", to_json(scan.robot_from_laser)},
          {"angle_min", scan.angle_min_rad},
          {"angle_increment", scan.angle_increment_rad},
          {"range_max", scan.range_max_m},
          {"ranges", std::move(ranges)},
          {"truth", scan.truth ? to_json(*scan.truth) : json(nullptr)}};
}

PeerScan scan_from(const json& entry) {
  PeerScan scan;
  scan.odom_from_robot = pose_from(entry.at("odom"));
  scan.robot_from_laser = pose_from(entry.at("laser"));
  scan.angle_min_rad = entry.at("angle_min").get<double>();
  scan.angle_increment_rad = entry.at("angle_increment").get<double>();
  scan.range_max_m = entry.at("range_max").get<double>();
  for (const json& range : entry.at("ranges")) {
    scan.ranges_m.push_back(number_from(range).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  if (!entry.at("truth").is_null()) scan.truth = pose_from(entry.at("truth"));
  return scan;
}

}  // namespace

PeerMap peer_map(const ReflectionGrid& map) {
  PeerMap peer;
  peer.resolution_m = map.resolution_m();
  peer.origin_x_m = map.rect().min.x * map.resolution_m();
  peer.origin_y_m = map.rect().min.y * map.resolution_m();
  peer.width = map.width();
  for (int y = map.rect().min.y; y < map.rect().max.y; ++y) {
    for (int x = map.rect().min.x; x < map.rect().max.x; ++x) {
      const float value = map.at({x, y});
      peer.cells.push_back(is_occupied(value) ? PeerMap::kOccupied
                           : is_known(value)  ? PeerMap::kFree
                                              : PeerMap::kUnknown);
    }
  }
  return peer;
}

PeerScan peer_scan(const Observation& observation, const std::optional<Pose2>& truth) {
  const Scan& scan = observation.scan;
  PeerScan peer{observation.odom_from_robot,
                scan.robot_from_laser,
                scan.bearing_rad(0),
                static_cast<double>(scan.angle_increment_rad),
                static_cast<double>(scan.range_max_m),
                {},
                truth};
  for (std::size_t i = 0; i < scan.size(); ++i) {
    peer.ranges_m.push_back(scan.kind(i) == BeamKind::kHit
                                ? static_cast<double>(scan.ranges_m[i])
                                : std::numeric_limits<double>::quiet_NaN());
  }
  return peer;
}

json to_json(const PeerJob& job) {
  json scans = json::array();
  for (const PeerScan& scan : job.scans) scans.push_back(to_json(scan));
  json covariance = json::array();
  for (int i = 0; i < 9; ++i) covariance.push_back(job.start.covariance(i / 3, i % 3));
  return {{"map",
           {{"resolution", job.map.resolution_m},
            {"origin", {job.map.origin_x_m, job.map.origin_y_m}},
            {"width", job.map.width},
            {"cells", job.map.cells}}},
          {"scans", std::move(scans)},
          {"start", {{"mean", to_json(job.start.mean)}, {"covariance", std::move(covariance)}}},
          {"seed", job.seed},
          {"particles", job.particles}};
}

PeerJob job_from_json(const json& document) {
  PeerJob job;
  const json& map = document.at("map");
  job.map = {map.at("resolution").get<double>(), map.at("origin").at(0).get<double>(),
             map.at("origin").at(1).get<double>(), map.at("width").get<int>(),
             map.at("cells").get<std::vector<int>>()};
  for (const json& scan : document.at("scans")) job.scans.push_back(scan_from(scan));
  const json& start = document.at("start");
  job.start.mean = pose_from(start.at("mean"));
  for (int i = 0; i < 9; ++i) {
    job.start.covariance(i / 3, i % 3) =
        start.at("covariance").at(static_cast<std::size_t>(i)).get<double>();
  }
  job.seed = document.at("seed").get<std::uint64_t>();
  job.particles = document.at("particles").get<std::size_t>();
  return job;
}

json to_json(const PeerResult& result) {
  json scans = json::array();
  for (std::size_t i = 0; i < result.estimates.size(); ++i) {
    scans.push_back({{"error_m", to_json(result.errors_m[i])},
                     {"error_rad", to_json(result.errors_rad[i])},
                     {"estimate", to_json(result.estimates[i])},
                     {"update_ms", result.update_ms[i]}});
  }
  return {{"scans", std::move(scans)}};
}

PeerResult result_from_json(const json& document, std::size_t scans) {
  PeerResult result;
  try {
    for (const json& scan : document.at("scans")) {
      result.errors_m.push_back(number_from(scan.at("error_m")));
      result.errors_rad.push_back(number_from(scan.at("error_rad")));
      result.estimates.push_back(pose_from(scan.at("estimate")));
      result.update_ms.push_back(scan.at("update_ms").get<double>());
    }
  } catch (const json::exception& error) {
    throw InputError("--peers", std::string("the answer is not one: ") + error.what(),
                     "build strata and its peers from the same source");
  }
  if (result.estimates.size() != scans) {
    throw InputError("--peers",
                     "answered " + std::to_string(result.estimates.size()) + " of " +
                         std::to_string(scans) + " scans",
                     "build strata and its peers from the same source");
  }
  return result;
}

}  // namespace strata::peers
