// SPDX-License-Identifier: Apache-2.0
/// From the labels worth following to the topologies of the next visit with their weights.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/parallel.hpp"
#include "core/topology/expansion.hpp"
#include "core/topology/particle.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {

/// A label to follow, with its scan.
struct Candidate {
  std::size_t parent = 0;
  int label = 0;
  double log_factor = 0.0;
  CandidateEvidence evidence;

  [[nodiscard]] double log_weight() const { return log_factor + evidence.log_evidence; }
};

/// The topologies before the newest visit; of each, the covariances of its visits when new.
struct Parents {
  std::span<const Hypothesis> hypotheses;
  std::span<const std::vector<Eigen::Matrix3d>> newest_covariances;
};

struct Generation {
  std::vector<Particle> particles;
  std::vector<double> log_weights;  ///< one a particle
  std::size_t optimized = 0;        ///< topologies tried
  std::size_t not_converged = 0;    ///< candidates that could not be evaluated, left out
};

/// Without those that cannot be among the `kept` best even if linearizing did them wrong.
[[nodiscard]] std::vector<Candidate> prune(std::vector<Candidate> candidates, std::size_t kept);

/// Every candidate, optimized. O(candidates x optimization).
[[nodiscard]] Generation evaluate_candidates(std::span<const Candidate> candidates,
                                             const Parents& parents, const VisitLog& log,
                                             const TopologyConfig& config, WorkerPool& pool);

/// Adds topologies that revise another one: two landmarks are one, or a visit belongs to another
/// landmark. What was decided while the robot's place was uncertain may be wrong once a later loop
/// has closed, and no label of a later visit could say so any more. Their scans are those of their
/// own labels (revised_scans).
void add_revisions(Generation& generation, VisitLog& log, const TopologyConfig& config,
                   WorkerPool& pool);

}  // namespace strata::topology
