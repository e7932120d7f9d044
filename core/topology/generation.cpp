// SPDX-License-Identifier: Apache-2.0
#include "core/topology/generation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/topology/dirichlet_process.hpp"
#include "core/topology/proposal.hpp"

namespace strata::topology {
namespace {

/// By so much linearizing may misjudge a topology against another one.
constexpr double kLinearizationErrorNats = 5.0;
/// Topologies that revise another one, tried after a visit, at most.
constexpr std::size_t kMostRevisions = 12;

/// Optimizes a topology from its poses; false when that does not converge.
bool evaluate_from(const std::vector<Pose2>& start, const VisitLog& log,
                   const TopologyConfig& config, Hypothesis& hypothesis) {
  Evidence evidence = evaluate(hypothesis.labels, log.measurements(log.size()), hypothesis.scans,
                               start, config.location);
  hypothesis.log_evidence = evidence.log_evidence;
  hypothesis.poses = std::move(evidence.poses);
  hypothesis.gaussian = std::move(evidence.gaussian);
  return evidence.converged && std::isfinite(evidence.log_evidence);
}

}  // namespace

std::vector<Candidate> without_hopeless(std::vector<Candidate> candidates, std::size_t kept) {
  if (candidates.size() <= kept) return candidates;
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].log_weight() > candidates[b].log_weight();
  });
  const double least = candidates[order[kept - 1]].log_weight() - kLinearizationErrorNats;
  std::vector<Candidate> hopeful;
  for (const std::size_t i : order) {
    if (hopeful.size() == 2 * kept || candidates[i].log_weight() < least) break;
    hopeful.push_back(std::move(candidates[i]));
  }
  return hopeful;
}

Generation settle(std::span<const Candidate> candidates, const Parents& parents,
                  const VisitLog& log, const TopologyConfig& config, WorkerPool& pool) {
  std::vector<std::optional<Particle>> settled(candidates.size());
  pool.for_chunks(candidates.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Candidate& candidate = candidates[i];
    const Hypothesis& parent = parents.hypotheses[candidate.parent];
    Particle particle{{parent.labels, 0.0, 0.0, {}, parent.scans, nullptr},
                      parents.newest_covariances[candidate.parent]};
    Hypothesis& next = particle.hypothesis;
    next.labels.push_back(candidate.label);
    if (candidate.sight.scan) next.scans.push_back(*candidate.sight.scan);
    if (!evaluate_from(candidate.sight.poses, log, config, next)) return;
    const std::size_t newest = log.size() - 1;
    particle.newest_covariances.push_back(block_of(next.gaussian->covariance_with(newest), newest));
    settled[i] = std::move(particle);
  });
  Generation generation;
  generation.optimized = candidates.size();
  for (std::size_t i = 0; i < settled.size(); ++i) {
    const double log_weight =
        settled[i] ? candidates[i].log_factor + settled[i]->hypothesis.log_evidence : 0.0;
    if (!settled[i] || !std::isfinite(log_weight)) {
      ++generation.not_converged;
      continue;
    }
    generation.particles.push_back(std::move(*settled[i]));
    generation.log_weights.push_back(log_weight);
  }
  return generation;
}

void add_revisions(Generation& generation, const VisitLog& log, const TopologyConfig& config,
                   WorkerPool& pool) {
  std::vector<Particle>& particles = generation.particles;
  std::set<Labels> known;
  for (const Particle& particle : particles) known.insert(particle.hypothesis.labels);
  const std::vector<std::size_t> order = by_weight(particles, generation.log_weights);
  std::vector<std::pair<std::size_t, Labels>> revised;  // from which particle
  for (std::size_t k = 0; k < order.size() && revised.size() < kMostRevisions; ++k) {
    const Hypothesis& from = particles[order[k]].hypothesis;
    for (auto* revisions : {mergers, moved_visits}) {
      for (Labels& labels : revisions(from, config.location)) {
        if (revised.size() == kMostRevisions) break;
        if (known.insert(labels).second) revised.emplace_back(order[k], std::move(labels));
      }
    }
  }
  generation.optimized += revised.size();
  std::vector<std::optional<Particle>> settled(revised.size());
  std::vector<double> log_weights(revised.size(), 0.0);
  pool.for_chunks(revised.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Particle& from = particles[revised[i].first];
    Particle particle{{revised[i].second, 0.0, 0.0, {}, from.hypothesis.scans, nullptr},
                      from.newest_covariances};
    Hypothesis& next = particle.hypothesis;
    if (!evaluate_from(from.hypothesis.poses, log, config, next)) return;
    log_weights[i] = generation.log_weights[revised[i].first] + next.log_evidence -
                     from.hypothesis.log_evidence +
                     log_partition_prior(next.labels, config.concentration) -
                     log_partition_prior(from.hypothesis.labels, config.concentration);
    settled[i] = std::move(particle);
  });
  for (std::size_t i = 0; i < revised.size(); ++i) {
    if (!settled[i] || !std::isfinite(log_weights[i])) continue;
    particles.push_back(std::move(*settled[i]));
    generation.log_weights.push_back(log_weights[i]);
  }
}

}  // namespace strata::topology
