// SPDX-License-Identifier: Apache-2.0
/// What the localizer says of itself: as a message after each scan, and in its diagnostics.
#pragma once

#include <chrono>
#include <string>

#include "components/bus/message_types.hpp"
#include "components/runtime/diagnostics.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localizer {

/// One scan's outcome with what it was found in and how long that took.
struct HealthReport {
  std::string model;  ///< name of the map model
  localization::LocalizationHealth health;
  double score = 0.0;  ///< LocalizationResult::score
  /// The robot is within this distance of the pose with 95% or more, if its covariance is right.
  double deviation_range_m = 0.0;
  double heading_stddev_rad = 0.0;
  double effective_sample_size = 0.0;
  std::size_t particles = 0;
  bool converged = false;
  bool is_ambiguous = false;
  std::size_t places = 0;      ///< that are still possible while it is; 0: none was found yet
  bool is_beyond_map = false;  ///< LocalizationResult::is_beyond_map
  bool is_recovering = false;  ///< LocalizationResult::is_recovering
  std::chrono::duration<double> update_time{0.0};

  /// Whether the pose can be trusted: VDA 5050's `localized`.
  [[nodiscard]] bool is_localized() const {
    return converged && !is_lost() && !is_probably_wrong();
  }
  /// One place is believed, and the score says that nine of ten such poses are wrong: as where a
  /// robot that was carried away takes itself to be outside of the map, in which nothing
  /// contradicts it.
  [[nodiscard]] bool is_probably_wrong() const {
    constexpr double kProbablyWrong = 0.1;
    return converged && !is_lost() && score < kProbablyWrong;
  }
  [[nodiscard]] bool is_lost() const { return health.state == localization::HealthState::kLost; }
};

/// update_time: by the wall clock, for this scan [s].
[[nodiscard]] HealthReport make_health_report(const std::string& model,
                                              const localization::LocalizationResult& result,
                                              std::chrono::duration<double> update_time);

/// The message at `stamp`, its header in `frame` (the map's); m, rad, nats, s.
[[nodiscard]] strata_msgs::msg::LocalizationHealth to_message(const HealthReport& report,
                                                              Stamp stamp,
                                                              const std::string& frame);

/// An error when lost; a warning while not localized, where the score says that the pose is wrong,
/// beyond the map, and where it is outdated; and the figures, among them localizationScore,
/// deviationRange [m] and localized as VDA 5050 names them.
void describe(const HealthReport& report, runtime::Health& health);

/// VDA 5050's figures before the first scan: not localized, score 0, no range.
void describe_unknown_place(runtime::Health& health);

}  // namespace strata::localizer
