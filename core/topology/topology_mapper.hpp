// SPDX-License-Identifier: Apache-2.0
/// Scans and odometry of one run in, the posterior over its topologies out, landmark by landmark.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/scan/scan.hpp"
#include "core/topology/mapper_config.hpp"
#include "core/topology/topology_filter.hpp"
#include "core/topology/visit_maker.hpp"

namespace strata::topology {

/// Where a mapper has come to.
struct TrackedMoment {
  Stamp stamp;
  Pose2 map_from_robot;
  std::optional<Pose2> odom_from_robot;  ///< if it came with the scan
};

/// Tracks the robot, makes visits of landmarks and hands them to the filter. The caller passes the
/// visits that `add` and `finish` return to `update`, each once and in order: that is the one step
/// that costs more than matching a scan, and may be timed, or done later. Not thread-safe; two
/// objects are independent. The same bits at any number of threads.
class TopologyMapper {
 public:
  /// keep: by default every scan. Throws ConfigError.
  explicit TopologyMapper(const TopologyMapperConfig& config, std::uint64_t seed = 1,
                          int threads = 1, const PathKeepConfig& keep = {});
  ~TopologyMapper();
  TopologyMapper(const TopologyMapper&) = delete;
  TopologyMapper& operator=(const TopologyMapper&) = delete;

  /// The next scan of the run. given: its pose where one is known, used instead of odometry and
  /// scan matching. A scan of another run than the first, with a stamp not after the last one, or
  /// with odometry that is not finite is skipped and counted, as is every scan once `is_full`.
  /// Returns the visits that are complete now. O(beams x iterations) but where a local cloud is
  /// made or looked at.
  [[nodiscard]] std::vector<MadeVisit> add(const Observation& observation,
                                           const Pose2* given = nullptr);
  /// The next scan of an earlier life of the mapper, with the pose that it gave it (`scans`):
  /// before any `add`, and with `mark` in between as it was then. Returns the visits that were
  /// complete then, for `update`. O(1) about but where local clouds are made or looked at.
  [[nodiscard]] std::vector<MadeVisit> restore(const PosedScan& tracked);
  /// After the last `restore`: the newest scan of that life, kept or not (`newest`). The robot is
  /// taken to be where it was then, and to have moved since as the odometry says; to have stood,
  /// where the odometry is left out, or has begun anew.
  void resume_from(const TrackedMoment& newest);
  /// The robot is or was at a landmark: beside those that are detected, or instead of them
  /// (`source: given`). False when it is not taken: see VisitMaker::mark, or the map is full.
  bool mark(Stamp stamp);
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
  /// Of the likeliest topology: the number that each landmark is called by, by label. It stays with
  /// its place over visits, and over days where the mapper is restored (PlaceNames).
  [[nodiscard]] const std::vector<int>& place_names() const;
  /// Every scan that is kept with its tracked pose, in the odometry frame at the first scan.
  [[nodiscard]] const std::vector<PosedScan>& scans() const;
  /// The last scan that was not skipped, kept or not.
  [[nodiscard]] const std::optional<TrackedMoment>& newest() const;
  /// Those not skipped, kept or not.
  [[nodiscard]] std::size_t tracked_scans() const;
  [[nodiscard]] std::size_t skipped_scans() const;
  /// Whether the scans have used up the memory they may.
  [[nodiscard]] bool is_full() const;
  /// What the filter counts, with landmarks given too late in `late_visits`.
  [[nodiscard]] TopologyCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strata::topology
