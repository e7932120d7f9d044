// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluate/trajectory_error.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"

namespace strata::tools {
namespace {

/// Collects the differences of two motions or poses.
class Errors {
 public:
  void add(const Pose2& estimate, const Pose2& truth) {
    const Pose2 difference = between(truth, estimate);
    translation_.push_back(std::hypot(difference.x, difference.y));
    rotation_.push_back(std::abs(difference.theta));
  }
  void add_unmatched() { ++unmatched_; }
  [[nodiscard]] TrajectoryErrors result() && {
    TrajectoryErrors errors;
    errors.matched = translation_.size();
    errors.unmatched = unmatched_;
    errors.translation_m = summarize(std::move(translation_));
    errors.rotation_rad = summarize(std::move(rotation_));
    return errors;
  }

 private:
  std::vector<double> translation_;
  std::vector<double> rotation_;
  std::size_t unmatched_ = 0;
};

}  // namespace

std::optional<Pose2> pose_at(std::span<const log::StampedPose> poses, Stamp stamp,
                             double max_gap_s) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp,
                       [](const log::StampedPose& pose, Stamp at) { return pose.stamp < at; });
  if (after != poses.end() && after->stamp == stamp) return after->pose;
  // Files round stamps to a microsecond or less; the neighbour of the same moment is the pose.
  const Duration same{2000};
  if (after != poses.end() && after->stamp - stamp <= same) return after->pose;
  if (after == poses.begin()) return std::nullopt;
  const log::StampedPose& before = *(after - 1);
  if (stamp - before.stamp <= same) return before.pose;
  if (after == poses.end() || (after->stamp - stamp).seconds() > max_gap_s ||
      (stamp - before.stamp).seconds() > max_gap_s) {
    return std::nullopt;
  }
  const double t = (stamp - before.stamp).seconds() / (after->stamp - before.stamp).seconds();
  return interpolate(before.pose, after->pose, t);
}

Pose2 alignment(std::span<const log::StampedPose> trajectory,
                std::span<const log::StampedPose> truth) {
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (const log::StampedPose& pose : trajectory) {
    const auto partner = pose_at(truth, pose.stamp);
    if (!partner) continue;
    source.push_back(pose.pose);
    target.push_back(*partner);
  }
  return source.empty() ? Pose2{} : align(source, target);
}

TrajectoryErrors absolute_errors(std::span<const log::StampedPose> trajectory,
                                 std::span<const log::StampedPose> truth,
                                 const Pose2& truth_from_trajectory) {
  Errors errors;
  for (const log::StampedPose& pose : trajectory) {
    if (const auto partner = pose_at(truth, pose.stamp)) {
      errors.add(truth_from_trajectory * pose.pose, *partner);
    } else {
      errors.add_unmatched();
    }
  }
  return std::move(errors).result();
}

TrajectoryErrors relative_errors(std::span<const log::StampedPose> trajectory,
                                 std::span<const log::StampedPose> truth, double delta_s) {
  Errors errors;
  const Duration delta = Duration::from_seconds(delta_s);
  for (const log::StampedPose& first : trajectory) {
    const Stamp later = first.stamp + delta;
    if (trajectory.back().stamp < later) break;
    const auto second = pose_at(trajectory, later);
    const auto true_first = pose_at(truth, first.stamp);
    const auto true_second = pose_at(truth, later);
    if (second && true_first && true_second) {
      errors.add(between(first.pose, *second), between(*true_first, *true_second));
    } else {
      errors.add_unmatched();
    }
  }
  return std::move(errors).result();
}

TrajectoryErrors relation_errors(std::span<const log::StampedPose> trajectory,
                                 std::span<const log::Relation> relations) {
  Errors errors;
  for (const log::Relation& relation : relations) {
    const auto first = pose_at(trajectory, relation.first);
    const auto second = pose_at(trajectory, relation.second);
    if (first && second) {
      errors.add(between(*first, *second), relation.first_from_second);
    } else {
      errors.add_unmatched();
    }
  }
  return std::move(errors).result();
}

PairedErrors paired_relation_errors(std::span<const log::StampedPose> trajectory,
                                    std::span<const log::StampedPose> other,
                                    std::span<const log::Relation> relations) {
  std::vector<log::Relation> in_time(relations.begin(), relations.end());
  std::stable_sort(
      in_time.begin(), in_time.end(),
      [](const log::Relation& a, const log::Relation& b) { return a.first < b.first; });
  std::vector<double> differences;
  Stamp begin;
  Stamp end;
  const auto error_m = [](const Pose2& first, const Pose2& second, const log::Relation& relation) {
    return between(relation.first_from_second, between(first, second)).translation().norm();
  };
  for (const log::Relation& relation : in_time) {
    const auto first = pose_at(trajectory, relation.first);
    const auto second = pose_at(trajectory, relation.second);
    const auto other_first = pose_at(other, relation.first);
    const auto other_second = pose_at(other, relation.second);
    if (!first || !second || !other_first || !other_second) continue;
    if (differences.empty()) begin = relation.first;
    end = relation.first;
    differences.push_back(error_m(*first, *second, relation) -
                          error_m(*other_first, *other_second, relation));
  }
  PairedErrors paired;
  paired.matched = differences.size();
  if (differences.empty()) return paired;
  paired.mean_difference_m = statistics::mean(differences);
  const double blocks = std::max(1.0, (end - begin).seconds() / kPairedBlock_s);
  const auto block =
      static_cast<std::size_t>(std::ceil(static_cast<double>(differences.size()) / blocks));
  const std::vector<double> ones(differences.size(), 1.0);
  paired.difference_m = statistics::moving_block_ratio(differences, ones, block, 0.95, 1);
  return paired;
}

}  // namespace strata::tools
