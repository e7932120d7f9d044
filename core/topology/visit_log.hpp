// SPDX-License-Identifier: Apache-2.0
/// All visits so far with what is measured between them, and the matches of their local clouds.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "core/topology/evidence.hpp"
#include "core/topology/topology_filter.hpp"

namespace strata::topology {

/// Whether its odometry is finite and its way a length.
[[nodiscard]] bool is_sound(const LandmarkVisit& visit);

/// Shared by all hypotheses. `match` may be called by several threads at once.
class VisitLog {
 public:
  explicit VisitLog(const TopologyConfig& config) : config_(config) {}

  /// Whether a visit at that time comes after the ones before.
  [[nodiscard]] bool follows(Stamp stamp) const;
  /// Requires is_sound(visit), is_sound(visit.cloud) and follows(visit.stamp).
  void add(LandmarkVisit visit);

  [[nodiscard]] std::size_t size() const { return visits_.size(); }
  [[nodiscard]] const LandmarkVisit& visit(std::size_t index) const { return visits_[index]; }
  /// Of the first `count` visits.
  [[nodiscard]] Measurements measurements(std::size_t count) const;

  /// The local cloud of visit b registered to that of visit a from about the guess a_from_b.
  /// Guesses are rounded, so that hypotheses that differ little share one match, whoever asks
  /// first.
  [[nodiscard]] PlaceMatch match(std::size_t a, std::size_t b, const Pose2& guess_a_from_b);
  /// How many different matches have failed.
  [[nodiscard]] std::size_t failed_matches() const;

 private:
  using Key = std::array<long, 5>;
  TopologyConfig config_;
  std::deque<LandmarkVisit> visits_;   // they stay where they are
  std::deque<PlaceSurface> surfaces_;  // of the visits' clouds
  std::vector<OdometryFactor> odometry_;
  std::vector<double> log_new_density_;
  Eigen::Vector2d min_{0.0, 0.0};
  Eigen::Vector2d max_{0.0, 0.0};
  mutable std::mutex mutex_;
  std::map<Key, PlaceMatch> matches_;
};

}  // namespace strata::topology
