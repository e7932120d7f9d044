// SPDX-License-Identifier: Apache-2.0
/// One topology and all topologies that one more visit can make of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/visit_log.hpp"

namespace strata::topology {

/// A topology after one more visit, before its scan was looked at.
struct Child {
  int label = 0;
  double log_prior = 0.0;     ///< of the label, by the Dirichlet process
  double log_odometry = 0.0;  ///< ln Z(L + j; odometry) - ln Z(L), eq. (17)
  Evidence evidence;          ///< with the odometry to the new visit, without its scan
};

struct Children {
  std::vector<Child> children;  ///< those worth following, by label
  std::size_t not_converged = 0;
  /// ln of the sum over children of prior times odometry likelihood: the normalizer of eq. (16).
  double log_normalizer = 0.0;
};

/// A hypothesis that has seen the newest visit's scan too.
struct Grown {
  Hypothesis hypothesis;
  Eigen::Matrix3d newest_covariance;
};

/// Every label for the newest visit of the log, appended to the parent (one visit less). Labels
/// whose landmark lies too far from where the odometry leads are left out without optimizing, as
/// are those less probable than the best by config.negligible nats. newest_covariances: how
/// uncertain the pose of each visit was when it was new, an upper bound of what it is now.
[[nodiscard]] Children expand(const Hypothesis& parent,
                              std::span<const Eigen::Matrix3d> newest_covariances,
                              const VisitLog& log, const TopologyConfig& config);

/// The child with its scan matched to the local maps of its landmark; its log_evidence is ln Z(L +
/// j; odometry, scan). Nothing when the optimization fails.
[[nodiscard]] std::optional<Grown> look(const Hypothesis& parent, const Child& child, VisitLog& log,
                                        const TopologyConfig& config);

}  // namespace strata::topology
