// SPDX-License-Identifier: Apache-2.0
#include "core/topology/visit_log.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace strata::topology {
namespace {

constexpr double kGuessStepM = 0.5;
constexpr double kGuessStepRad = 0.2;
/// How far around the guess matching begins: about what the odometry leaves open.
constexpr double kStartOffsetM = 0.4;
constexpr double kStartOffsetRad = 0.25;

std::array<Pose2, 7> starts_around(const Pose2& guess) {
  return {guess,
          guess * Pose2{0.0, 0.0, kStartOffsetRad},
          guess * Pose2{0.0, 0.0, -kStartOffsetRad},
          guess * Pose2{kStartOffsetM, 0.0, 0.0},
          guess * Pose2{-kStartOffsetM, 0.0, 0.0},
          guess * Pose2{0.0, kStartOffsetM, 0.0},
          guess * Pose2{0.0, -kStartOffsetM, 0.0}};
}

}  // namespace

bool is_sound(const LandmarkVisit& visit) {
  return is_finite(visit.odom_from_robot) && std::isfinite(visit.path_length_m) &&
         visit.path_length_m >= 0.0;
}

bool VisitLog::follows(Stamp stamp) const {
  return visits_.empty() || visits_.back().stamp < stamp;
}

void VisitLog::add(LandmarkVisit visit) {
  const Eigen::Vector2d at = visit.odom_from_robot.translation();
  if (visits_.empty()) {
    min_ = max_ = at;
  } else {
    const Pose2 step = between(visits_.back().odom_from_robot, visit.odom_from_robot);
    const double path_length_m = std::max(visit.path_length_m, step.translation().norm());
    odometry_.push_back(odometry_step(step, path_length_m, config_.odometry));
  }
  min_ = min_.cwiseMin(at);
  max_ = max_.cwiseMax(at);
  // By the odometry, which all hypotheses share: the density must not depend on the topology.
  const Eigen::Vector2d extent =
      max_ - min_ + Eigen::Vector2d::Constant(2.0 * config_.location.area_margin_m);
  log_new_density_.push_back(-std::log(2.0 * std::numbers::pi * extent.x() * extent.y()));
  visits_.push_back(std::move(visit));
  surfaces_.emplace_back(visits_.back().cloud, config_.match.first_gate_m);
}

Measurements VisitLog::measurements(std::size_t count) const {
  return {std::span(odometry_).first(count == 0 ? 0 : count - 1),
          std::span(log_new_density_).first(count)};
}

PlaceMatch VisitLog::match(std::size_t a, std::size_t b, const Pose2& guess) {
  const Key key{static_cast<long>(a), static_cast<long>(b), std::lround(guess.x / kGuessStepM),
                std::lround(guess.y / kGuessStepM), std::lround(guess.theta / kGuessStepRad)};
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = matches_.find(key); found != matches_.end()) return found->second;
  }
  const Pose2 rounded{static_cast<double>(key[2]) * kGuessStepM,
                      static_cast<double>(key[3]) * kGuessStepM,
                      static_cast<double>(key[4]) * kGuessStepRad};
  const PlaceMatch match =
      match_clouds(surfaces_[a], visits_[b].cloud, starts_around(rounded), config_.match);
  const std::lock_guard lock(mutex_);
  matches_.emplace(key, match);
  return match;
}

std::size_t VisitLog::failed_matches() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(std::count_if(
      matches_.begin(), matches_.end(), [](const auto& entry) { return !entry.second.converged; }));
}

}  // namespace strata::topology
