// SPDX-License-Identifier: Apache-2.0
#include "core/topology/generation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/topology/detail/terms.hpp"
#include "core/topology/dirichlet_process.hpp"
#include "core/topology/proposal.hpp"
#include "core/topology/revised_scans.hpp"

namespace strata::topology {
namespace {

/// By so much linearizing may misjudge a topology against another one.
constexpr double kLinearizationErrorNats = 5.0;
/// Topologies that revise another one, tried after a visit, at most.
constexpr std::size_t kMaxRevisions = 12;
/// Topologies that are revised, the heaviest.
constexpr std::size_t kRevisedParticles = 4;

/// Optimizes a topology from its poses; false when that does not converge. before: as `evaluate`.
bool evaluate_from(const std::vector<Pose2>& start, const VisitLog& log,
                   const TopologyConfig& config, const LocationGaussian* before,
                   Hypothesis& hypothesis) {
  Evidence evidence = evaluate(hypothesis.labels, log.measurements(log.size()), hypothesis.scans,
                               start, config.location, before);
  hypothesis.log_evidence = evidence.log_evidence;
  hypothesis.poses = std::move(evidence.poses);
  hypothesis.gaussian = std::move(evidence.gaussian);
  return evidence.converged && std::isfinite(evidence.log_evidence);
}

/// A topology that revises that of a particle.
struct Revision {
  std::size_t parent = 0;
  Labels labels;
  double log_weight = 0.0;  // about
};

/// ln of the joint density of these labels, what was measured, and the poses of the hypothesis,
/// which are held, as are its scans: poses that fit the labels better can only raise it.
double log_density_held(const Labels& labels, const Hypothesis& hypothesis, const VisitLog& log,
                        const TopologyConfig& config) {
  const detail::Terms terms =
      detail::collect(labels, log.measurements(log.size()), hypothesis.scans, config.location);
  return terms.log_constant - detail::cost_at(terms, hypothesis.poses, config.location) +
         log_partition_prior(labels, config.concentration);
}

/// Those of the heaviest particles that promise most, most first; judged with the poses held, for
/// there are more than can be optimized, and one that does not come to its turn would not do so
/// after the next visit either.
std::vector<Revision> best_revisions(const Generation& generation, const VisitLog& log,
                                     const TopologyConfig& config) {
  std::set<Labels> known;
  for (const Particle& particle : generation.particles) known.insert(particle.hypothesis.labels);
  std::vector<std::size_t> order = by_weight(generation.particles, generation.log_weights);
  order.resize(std::min(order.size(), kRevisedParticles));
  std::vector<Revision> revisions;
  for (const std::size_t parent : order) {
    const Hypothesis& from = generation.particles[parent].hypothesis;
    const double held = log_density_held(from.labels, from, log, config);
    for (auto* revise : {mergers, moved_visits}) {
      for (Labels& labels : revise(from, config.location)) {
        if (!known.insert(labels).second) continue;
        const double promise = log_density_held(labels, from, log, config) - held;
        revisions.push_back({parent, std::move(labels), generation.log_weights[parent] + promise});
      }
    }
  }
  std::stable_sort(revisions.begin(), revisions.end(), [](const Revision& a, const Revision& b) {
    return a.log_weight > b.log_weight;
  });
  if (revisions.size() > kMaxRevisions) revisions.resize(kMaxRevisions);
  return revisions;
}

}  // namespace

std::vector<Candidate> prune(std::vector<Candidate> candidates, std::size_t kept) {
  if (candidates.size() <= kept) return candidates;
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].log_weight() > candidates[b].log_weight();
  });
  const double least = candidates[order[kept - 1]].log_weight() - kLinearizationErrorNats;
  std::vector<Candidate> promising;
  for (const std::size_t i : order) {
    if (promising.size() == 2 * kept || candidates[i].log_weight() < least) break;
    promising.push_back(std::move(candidates[i]));
  }
  return promising;
}

Generation evaluate_candidates(std::span<const Candidate> candidates, const Parents& parents,
                               const VisitLog& log, const TopologyConfig& config,
                               WorkerPool& pool) {
  std::vector<std::optional<Particle>> evaluated(candidates.size());
  pool.for_chunks(candidates.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Candidate& candidate = candidates[i];
    const Hypothesis& parent = parents.hypotheses[candidate.parent];
    Particle particle{{parent.labels, 0.0, 0.0, {}, parent.scans, nullptr},
                      parents.newest_covariances[candidate.parent]};
    Hypothesis& next = particle.hypothesis;
    next.labels.push_back(candidate.label);
    if (candidate.evidence.scan) next.scans.push_back(*candidate.evidence.scan);
    if (!evaluate_from(candidate.evidence.poses, log, config, parent.gaussian.get(), next)) return;
    const std::size_t newest = log.size() - 1;
    particle.newest_covariances.push_back(next.gaussian->covariance_of(newest));
    evaluated[i] = std::move(particle);
  });
  Generation generation;
  generation.optimized = candidates.size();
  for (std::size_t i = 0; i < evaluated.size(); ++i) {
    const double log_weight =
        evaluated[i] ? candidates[i].log_factor + evaluated[i]->hypothesis.log_evidence : 0.0;
    if (!evaluated[i] || !std::isfinite(log_weight)) {
      ++generation.not_converged;
      continue;
    }
    generation.particles.push_back(std::move(*evaluated[i]));
    generation.log_weights.push_back(log_weight);
  }
  return generation;
}

void add_revisions(Generation& generation, VisitLog& log, const TopologyConfig& config,
                   WorkerPool& pool) {
  std::vector<Particle>& particles = generation.particles;
  const std::vector<Revision> revised = best_revisions(generation, log, config);
  generation.optimized += revised.size();
  std::vector<std::optional<Particle>> evaluated(revised.size());
  std::vector<double> log_weights(revised.size(), 0.0);
  pool.for_chunks(revised.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Particle& from = particles[revised[i].parent];
    Particle particle{{revised[i].labels, 0.0, 0.0, {}, {}, nullptr}, from.newest_covariances};
    particle.hypothesis.scans = revised_scans(from, revised[i].labels, log, config);
    Hypothesis& next = particle.hypothesis;
    if (!evaluate_from(from.hypothesis.poses, log, config, nullptr, next)) return;
    log_weights[i] = generation.log_weights[revised[i].parent] + next.log_evidence -
                     from.hypothesis.log_evidence +
                     log_partition_prior(next.labels, config.concentration) -
                     log_partition_prior(from.hypothesis.labels, config.concentration);
    evaluated[i] = std::move(particle);
  });
  for (std::size_t i = 0; i < revised.size(); ++i) {
    if (!evaluated[i] || !std::isfinite(log_weights[i])) continue;
    particles.push_back(std::move(*evaluated[i]));
    generation.log_weights.push_back(log_weights[i]);
  }
}

}  // namespace strata::topology
