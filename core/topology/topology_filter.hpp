// SPDX-License-Identifier: Apache-2.0
/// The posterior over topologies, one landmark visit after the other [ranganathan2006rao,
/// algorithm 1] (docs/theory/topological_mapping.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/topology/config.hpp"
#include "core/topology/evidence.hpp"
#include "core/topology/local_cloud.hpp"
#include "core/topology/partition.hpp"
#include "core/topology/topology_summary.hpp"

namespace strata::topology {

/// The robot has come to a landmark: some landmark, it does not know which.
struct LandmarkVisit {
  Stamp stamp;
  Pose2 odom_from_robot;       ///< odometry at the visit
  double path_length_m = 0.0;  ///< path driven since the visit before
  LocalCloud cloud;  ///< local cloud in the frame of the robot; empty: only odometry counts
};

/// One topology with its probability and what it says about the landmarks.
struct Hypothesis {
  Labels labels;
  double probability = 0.0;
  double log_evidence = 0.0;
  /// Most probable pose of every visit, map_from_robot; the map frame is the odometry frame at the
  /// first visit.
  std::vector<Pose2> poses;
  std::vector<ScanFactor> scans;  ///< local clouds registered to each other
  /// The Gaussian around the poses; never null.
  std::shared_ptr<const LocationGaussian> gaussian;
};

/// What did not go as it should.
struct TopologyCounts {
  std::size_t late_visits = 0;     ///< skipped: not after the one before
  std::size_t broken_visits = 0;   ///< skipped: odometry or way that is not finite or negative
  std::size_t empty_clouds = 0;    ///< visits without a local cloud, or with one that is not finite
  std::size_t failed_matches = 0;  ///< pairs of visits whose local clouds did not fit
  std::size_t optimized = 0;       ///< topologies evaluated: what the visits cost
  std::size_t not_converged = 0;   ///< optimizations that did not converge; their label is dropped
  std::size_t near_landmarks =
      0;  ///< pairs that the likeliest topology now puts within a metre, or
          ///< two standard deviations of a revisit: perhaps one landmark
};

/// Rao-Blackwellized particle filter: a particle is a topology with a Gaussian over the landmark
/// locations. Particles of equal topologies are one with their sum of weights, since everything
/// else of them is equal too. Departures from the paper: the weight contains the normalizer of the
/// proposal, which differs between particles (`weighting: paper` leaves it out as printed); a new
/// landmark is evaluated like a known one; labels are proposed by the linearized odometry
/// likelihood (the weights make up for what linearizing does to the proposal), and with `expansion:
/// best` only the topologies that may be among the best after linearizing are optimized; by default
/// the most probable topologies are kept exactly
/// (`expansion: particles` draws them, as the paper does, parents and labels from one comb): where
/// many topologies are left fifty draws scatter, the fifty best do not; with as many as there are
/// topologies it enumerates. A match counts no more than that another place may look the same. Not
/// thread-safe; two objects are independent. The same bits at any number of
/// threads.
class TopologyFilter {
 public:
  /// Throws ConfigError.
  explicit TopologyFilter(const TopologyConfig& config, std::uint64_t seed = 1, int threads = 1);
  ~TopologyFilter();
  TopologyFilter(const TopologyFilter&) = delete;
  TopologyFilter& operator=(const TopologyFilter&) = delete;

  /// Adds a visit; false when it was skipped (see the counts). O(unique topologies x labels near
  /// the robot x optimization).
  bool add(LandmarkVisit visit);

  /// All topologies kept, most probable first; probabilities sum to one. Empty before the first
  /// visit.
  [[nodiscard]] const std::vector<Hypothesis>& posterior() const;
  /// The landmark locations of a hypothesis of the posterior: pose of each visit, with covariance.
  [[nodiscard]] std::vector<Pose2Gaussian> locations(const Hypothesis& hypothesis) const;
  /// The most probable ones, at most as many as asked for. O(landmarks x fill of the factor) each.
  [[nodiscard]] std::vector<TopologySummary> summaries(std::size_t most) const;
  [[nodiscard]] std::size_t visits() const;
  [[nodiscard]] const TopologyCounts& counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strata::topology
