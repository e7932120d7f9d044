// SPDX-License-Identifier: Apache-2.0
/// Scans and odometry of one run in, the posterior over its topologies out, landmark by landmark.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/scan/scan.hpp"
#include "core/topology/mapper_config.hpp"
#include "core/topology/topology_filter.hpp"
#include "core/topology/visit_maker.hpp"

namespace strata::topology {

/// Tracks the robot, makes visits of landmarks and hands them to the filter. The caller passes the
/// visits that `add` and `finish` return to `update`, each once and in order: that is the one step
/// that costs more than matching a scan, and may be timed, or done later. Not thread-safe; two
/// objects are independent. The same bits at any number of threads.
class TopologyMapper {
 public:
  /// Throws ConfigError.
  explicit TopologyMapper(const TopologyMapperConfig& config, std::uint64_t seed = 1,
                          int threads = 1);
  ~TopologyMapper();
  TopologyMapper(const TopologyMapper&) = delete;
  TopologyMapper& operator=(const TopologyMapper&) = delete;

  /// The next scan of the run. given: its pose where one is known, used instead of odometry and
  /// scan matching. A scan of another run than the first, with a stamp not after the last one, or
  /// with odometry that is not finite is skipped and counted. Returns the visits that are complete
  /// now. O(beams x iterations) but where a local map is made or looked at.
  [[nodiscard]] std::vector<MadeVisit> add(const Observation& observation,
                                           const Pose2* given = nullptr);
  /// The next scan of an earlier life of the mapper, with the pose that it gave it (`scans`):
  /// before any `add`, and with `mark` in between as it was then. Returns the visits that were
  /// complete then, for `update`. O(1) about but where local maps are made or looked at.
  [[nodiscard]] std::vector<MadeVisit> restore(const PosedScan& tracked);
  /// After the last `restore`: the odometry of that scan, from which the next one's has gone on.
  /// Without it the robot is taken to be where it was then, and its odometry to have begun anew.
  void resume_from(const Pose2& odom_from_robot);
  /// The robot is or was at a landmark: beside those that are detected, or instead of them
  /// (`source: given`).
  void mark(Stamp stamp);
  /// The visits whose surroundings the robot has not left yet.
  [[nodiscard]] std::vector<MadeVisit> finish();
  /// One landmark; false when the filter skipped it. See TopologyFilter::add.
  bool update(MadeVisit visit);

  [[nodiscard]] const TopologyMapperConfig& config() const;
  [[nodiscard]] int threads() const;
  [[nodiscard]] const TopologyFilter& filter() const;
  [[nodiscard]] const std::vector<Hypothesis>& posterior() const { return filter().posterior(); }
  /// Those that the filter took, in order.
  [[nodiscard]] const std::vector<MadeVisit>& visits() const;
  /// Every scan not skipped with its tracked pose, in the odometry frame at the first scan.
  [[nodiscard]] const std::vector<PosedScan>& scans() const;
  [[nodiscard]] std::size_t skipped_scans() const;
  /// What the filter counts, with landmarks given too late in `late_visits`.
  [[nodiscard]] TopologyCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strata::topology
