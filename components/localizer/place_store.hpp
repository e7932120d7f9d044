// SPDX-License-Identifier: Apache-2.0
/// Where the robot was last, in a small file, so that a restarted localizer goes on from there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/log/background_file.hpp"
#include "components/runtime/resume.hpp"
#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::localizer {

struct PlaceStoreConfig {
  std::string file;
  double period_s = 1.0;
  runtime::DeadReckoningConfig dead_reckoning;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("file", c.file,
            {.doc = "live: keep the pose in this file while the robot is localized, and begin "
                    "there when it exists, whatever start.pose says; empty: do not",
             .when = "the robot shall find itself at once after a restart"});
    v.field("period_s", c.period_s,
            {.doc = "written this often, by the stamps of the scans", .unit = "s", .min = 0.0});
    runtime::DeadReckoningConfig::describe(c.dead_reckoning, v);
  }
};

/// Not thread-safe.
class PlaceStore {
 public:
  /// added: covariance on top of the kept one, for what may have happened in between.
  PlaceStore(PlaceStoreConfig config, Eigen::Matrix3d added);

  /// Reads the file, if there is one. Throws InputError for one that cannot be read, DamageError
  /// for one that is damaged, and then goes on as if there were none.
  void load();
  /// Of a building, where the robot was; empty: it was not known, or there are none.
  [[nodiscard]] std::string level() const { return kept_ ? kept_->level : std::string(); }
  /// Something newer is known.
  void forget() { kept_.reset(); }
  [[nodiscard]] bool has_place() const { return kept_.has_value(); }
  /// Whether the first observation lacks the odometry that takes the kept place on.
  [[nodiscard]] bool waits_for_odometry(const Observation& first, bool use_odometry) const;
  /// The first observation, which may come long before there is a map.
  void hear(const Observation& first);
  struct Resumed {
    Pose2Gaussian map_from_robot;
    bool fits = true;  ///< the scan looks as the map does there, as far as that can be told
  };
  /// Where the robot is: once, and only when a place was kept. The scan tells whether odometry has
  /// gone on (slam::resumed_place); without a map it is taken to for as long as it is recent.
  /// O(cells).
  [[nodiscard]] std::optional<Resumed> resume(const Observation& now, const ReflectionGrid& map);
  /// Has the pose written, no more often than the config says; all of it or nothing. Returns at
  /// once. Throws OutputError when an earlier one could not be written.
  void keep(const Observation& observation, const Pose2Gaussian& map_from_robot,
            const std::string& level = {});
  /// Waits until what was kept is written; throws as keep.
  void flush() { file_.flush(); }

 private:
  /// What the file says.
  struct Kept {
    std::vector<double> map_from_robot;  ///< x, y [m], theta [rad]
    std::vector<double> covariance;      ///< row by row
    std::vector<double> odom_from_robot;
    std::int64_t stamp_ns = 0;
    std::string level;
    [[nodiscard]] runtime::KeptMoment moment() const;
    template <class Self, class V>
    static void describe(Self& c, V& v);
  };

  PlaceStoreConfig config_;
  Eigen::Matrix3d added_;
  std::optional<Kept> kept_;
  std::optional<bool> is_recent_;  ///< the first observation, after the kept one
  std::optional<Stamp> written_;
  log::BackgroundFile file_;
};

}  // namespace strata::localizer
