// SPDX-License-Identifier: Apache-2.0
/// How far a trajectory is from the truth.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "components/log/relations_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/geometry/pose2.hpp"
#include "tools/statistics/error_summary.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::tools {

using statistics::ErrorSummary;
using statistics::summarize;

struct TrajectoryErrors {
  std::size_t matched = 0;    ///< poses or relations that entered
  std::size_t unmatched = 0;  ///< without a partner in time
  ErrorSummary translation_m;
  ErrorSummary rotation_rad;
};

/// The pose at a moment: interpolated between neighbours at most max_gap_s apart from it, else
/// nothing. `poses` sorted by stamp. O(log n).
[[nodiscard]] std::optional<Pose2> pose_at(std::span<const log::StampedPose> poses, Stamp stamp,
                                           double max_gap_s = 0.5);

/// The rigid motion (no scale) that brings the trajectory closest to the truth, from the poses that
/// have a partner [horn1987closed]; identity when none has.
[[nodiscard]] Pose2 alignment(std::span<const log::StampedPose> trajectory,
                              std::span<const log::StampedPose> truth);

/// Pose by pose, after truth_from_trajectory was applied (identity: absolute errors).
[[nodiscard]] TrajectoryErrors absolute_errors(std::span<const log::StampedPose> trajectory,
                                               std::span<const log::StampedPose> truth,
                                               const Pose2& truth_from_trajectory);

/// Motions over delta_s of time: the pose of the later seen from the earlier, in both.
[[nodiscard]] TrajectoryErrors relative_errors(std::span<const log::StampedPose> trajectory,
                                               std::span<const log::StampedPose> truth,
                                               double delta_s);

/// Kümmerle et al. [kummerle2009measuring, eq. (2)]: motions between the pairs of moments that the
/// relations name, each compared with the relation; translation and rotation apart.
[[nodiscard]] TrajectoryErrors relation_errors(std::span<const log::StampedPose> trajectory,
                                               std::span<const log::Relation> relations);

/// How much larger the errors of one trajectory are than those of another, relation by relation.
struct PairedErrors {
  std::size_t matched = 0;
  double mean_difference_m = 0.0;     ///< of translation; below zero: the first one is better
  statistics::Interval difference_m;  ///< 95%, by moving blocks of kPairedBlock_s
};
/// Relations near in time share what is wrong with the poses there: longer than a room's visit.
inline constexpr double kPairedBlock_s = 60.0;
/// Over the relations that both have a partner for. Requires one.
[[nodiscard]] PairedErrors paired_relation_errors(std::span<const log::StampedPose> trajectory,
                                                  std::span<const log::StampedPose> other,
                                                  std::span<const log::Relation> relations);

}  // namespace strata::tools
