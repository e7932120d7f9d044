// SPDX-License-Identifier: Apache-2.0
/// One topology and all topologies that one more visit can make of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/prediction.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {

/// A topology after one more visit, before its scan is evaluated.
struct Child {
  int label = 0;
  double log_prior = 0.0;     ///< of the label, by the Dirichlet process
  double log_odometry = 0.0;  ///< ln Z(L + j; odometry) - ln Z(L), eq. (17), linearized
  std::vector<Pose2> poses;   ///< most probable then, linearized
};

struct Children {
  std::vector<Child> children;  ///< those worth following, by label
  /// ln of the sum over children of prior times odometry likelihood: the normalizer of eq. (16).
  double log_normalizer = 0.0;
};

/// A child with the newest visit's scan too, linearized: its evidence is to be had from
/// `evaluate`, starting at these poses.
struct CandidateEvidence {
  std::optional<ScanFactor> scan;
  double log_evidence = 0.0;  ///< about
  std::vector<Pose2> poses;
};

/// Every label for the newest visit of the log, appended to the parent (one visit less), whose
/// prediction is given. Labels whose landmark lies too far from where the odometry leads are left
/// out, as are those less probable than the best by config.negligible nats. newest_covariances: how
/// uncertain the pose of each visit was when it was new, an upper bound of what it is now. Nothing
/// is optimized here: the paper's m optimizations a particle are one linear update each.
[[nodiscard]] Children expand(const Hypothesis& parent, Prediction& prediction,
                              std::span<const Eigen::Matrix3d> newest_covariances,
                              const VisitLog& log, const TopologyConfig& config);

/// The newest local cloud registered to those of a known landmark: the best match, or a failed one.
struct Overlap {
  int label = 0;
  ScanFactor scan;
};

/// One for every known landmark among the children whose local clouds, and that of the newest
/// visit, have points. newest_pose: where the odometry alone leads. Matching starts where the child
/// is, and there if that says less than a match can: a match that begins only where the label puts
/// the visit does not find that the maps fit a metre away, which says that the place is another
/// one.
[[nodiscard]] std::vector<Overlap> find_overlaps(const Hypothesis& parent, const Children& children,
                                                 const Pose2& newest_pose, VisitLog& log,
                                                 const CloudMatchConfig& config);

/// The child with its scan: matched to the local clouds of its landmark, or of another one that
/// lies so near that both see the same walls. The paper matches within a landmark only, its
/// landmarks lying further apart than its maps reach; else two neighbours would be taken for one
/// because their maps overlap, whichever metres apart the match puts them. That the map of the
/// label's own landmark does not fit counts against the label, whichever cloud is then registered
/// to it.
[[nodiscard]] CandidateEvidence candidate_evidence(const Hypothesis& parent, const Child& child,
                                                   std::span<const Overlap> overlaps,
                                                   Prediction& prediction,
                                                   const TopologyConfig& config,
                                                   double log_new_density);

}  // namespace strata::topology
