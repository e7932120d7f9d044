// SPDX-License-Identifier: Apache-2.0
/// Where the robot was last, in a small file, so that a restarted localizer goes on from there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/scan/scan.hpp"

namespace strata::localizer {

struct PlaceStoreConfig {
  std::string file;
  double period_s = 1.0;
  double carry_s = 10.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("file", c.file,
            {.doc = "live: keep the pose in this file while the robot is localized, and begin "
                    "there when it exists, whatever start.pose says; empty: do not"});
    v.field("period_s", c.period_s,
            {.doc = "written this often, by the stamps of the scans", .unit = "s", .min = 0.0});
    v.field("carry_s", c.carry_s,
            {.doc = "when the first scan is at most this much younger than the kept pose, the "
                    "odometry has gone on and carries the pose; later it may have begun anew",
             .unit = "s",
             .min = 0.0});
  }
};

/// Not thread-safe.
class PlaceStore {
 public:
  /// added: covariance on top of the kept one, for what may have happened in between.
  PlaceStore(PlaceStoreConfig config, Eigen::Matrix3d added);

  /// Reads the file, if there is one. Throws InputError, and then goes on as if there were none.
  void load();
  /// Something newer is known.
  void forget() { kept_.reset(); }
  /// Where the robot is at its first observation: once, and only when a place was kept.
  [[nodiscard]] std::optional<Pose2Gaussian> resume(const Observation& first);
  /// Writes the pose, no more often than the config says; all of it or nothing. Throws OutputError.
  void keep(const Observation& observation, const Pose2Gaussian& map_from_robot);

 private:
  /// What the file says.
  struct Kept {
    std::vector<double> map_from_robot;  ///< x, y [m], theta [rad]
    std::vector<double> covariance;      ///< row by row
    std::vector<double> odom_from_robot;
    std::int64_t stamp_ns = 0;
    template <class Self, class V>
    static void describe(Self& c, V& v);
  };

  PlaceStoreConfig config_;
  Eigen::Matrix3d added_;
  std::optional<Kept> kept_;
  std::optional<Stamp> written_;
};

}  // namespace strata::localizer
