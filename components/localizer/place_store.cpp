// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/place_store.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "components/settings/config_reader.hpp"
#include "components/settings/config_writer.hpp"
#include "core/base/damage.hpp"
#include "core/slam/resumed_place.hpp"

namespace strata::localizer {
namespace {

Pose2 pose_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

std::vector<double> values_of(const Pose2& pose) { return {pose.x, pose.y, pose.theta}; }

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

}  // namespace

template <class Self, class V>
void PlaceStore::Kept::describe(Self& c, V& v) {
  v.field("map_from_robot", c.map_from_robot, {.doc = "x, y [m], theta [rad]"});
  v.field("covariance", c.covariance, {.doc = "of x, y, theta, row by row"});
  v.field("odom_from_robot", c.odom_from_robot, {.doc = "at that moment; empty: no odometry"});
  v.field("stamp_ns", c.stamp_ns, {.doc = "of the scan", .unit = "ns"});
  v.field("level", c.level, {.doc = "of a building; empty: none"});
  v.require(c.map_from_robot.size() == 3 && all_finite(c.map_from_robot), "map_from_robot",
            "is not three numbers", "remove the file");
  v.require(c.covariance.size() == 9 && all_finite(c.covariance), "covariance",
            "is not nine numbers", "remove the file");
  v.require(
      (c.odom_from_robot.empty() || c.odom_from_robot.size() == 3) && all_finite(c.odom_from_robot),
      "odom_from_robot", "is not three numbers", "remove the file");
}

PlaceStore::PlaceStore(PlaceStoreConfig config, Eigen::Matrix3d added)
    : config_(std::move(config)),
      added_(std::move(added)),
      file_(config_.file, log::write_whole_file) {}

void PlaceStore::load() {
  std::error_code error;
  if (config_.file.empty() || !std::filesystem::exists(config_.file, error)) return;
  try {
    kept_ = settings::read_config<Kept>(settings::load_document(config_.file), config_.file);
  } catch (const ConfigError& reason) {
    throw DamageError(config_.file, "is no kept pose: " + reason.problem(),
                      "remove it; the robot starts without it");
  }
}

runtime::KeptMoment PlaceStore::Kept::moment() const {
  return {Stamp{stamp_ns}, !odom_from_robot.empty()};
}

bool PlaceStore::waits_for_odometry(const Observation& first, bool use_odometry) const {
  return kept_ && use_odometry && needs_odometry(kept_->moment(), first, config_.dead_reckoning);
}

void PlaceStore::hear(const Observation& first) {
  if (kept_ && !is_recent_) {
    is_recent_ = is_dead_reckoned(kept_->moment(), first, config_.dead_reckoning);
  }
}

std::optional<PlaceStore::Resumed> PlaceStore::resume(const Observation& now,
                                                      const ReflectionGrid& map) {
  hear(now);
  const std::optional<Kept> kept = std::exchange(kept_, std::nullopt);
  if (!kept) return std::nullopt;
  Resumed resumed;
  resumed.map_from_robot.covariance =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kept->covariance.data()) +
      added_;
  slam::KeptPlace place{Stamp{kept->stamp_ns}, std::nullopt, pose_of(kept->map_from_robot)};
  Pose2 dead_reckoned = place.map_from_robot;
  if (!kept->odom_from_robot.empty()) {
    place.odom_from_robot = pose_of(kept->odom_from_robot);
    if (now.has_odometry) {
      dead_reckoned = dead_reckoned * between(*place.odom_from_robot, now.odom_from_robot);
    }
  }
  Pose2& mean = resumed.map_from_robot.mean;
  mean = *is_recent_ ? dead_reckoned : place.map_from_robot;
  if (map.size() == 0) return resumed;
  const slam::ResumedPlace found = slam::resumed_place(place, now, *is_recent_, map);
  resumed.fits = found.fits();
  // The filter finds it more exactly than the steps of the search do, unless it was long away.
  if (found.is_dead_reckoned != *is_recent_) mean = found.map_from_robot;
  return resumed;
}

void PlaceStore::keep(const Observation& observation, const Pose2Gaussian& map_from_robot,
                      const std::string& level) {
  const Stamp now = observation.scan.stamp;
  if (config_.file.empty()) return;
  // A clock that was set back must not stop the writing.
  if (written_ && std::abs((now - *written_).seconds()) < config_.period_s) return;
  written_ = now;
  Kept kept;
  kept.map_from_robot = values_of(map_from_robot.mean);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = map_from_robot.covariance;
  kept.covariance.assign(rows.data(), rows.data() + rows.size());
  if (observation.has_odometry) kept.odom_from_robot = values_of(observation.odom_from_robot);
  kept.stamp_ns = now.ns;
  kept.level = level;
  const std::string text = settings::write_yaml(kept);
  file_.write(log::Bytes(text.begin(), text.end()));
  file_.check();
}

}  // namespace strata::localizer
