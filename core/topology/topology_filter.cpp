// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_filter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/topology/dirichlet_process.hpp"
#include "core/topology/expansion.hpp"
#include "core/topology/particle.hpp"
#include "core/topology/proposal.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {
namespace {

/// By so much linearizing may misjudge a topology against another one.
constexpr double kLinearizationErrorNats = 5.0;
/// Topologies with two landmarks made one that are tried after a visit, about at most.
constexpr std::size_t kMostMergers = 12;

/// A label to follow, with its scan.
struct Candidate {
  std::size_t parent = 0;
  int label = 0;
  double log_factor = 0.0;
  Sight sight;

  [[nodiscard]] double log_weight() const { return log_factor + sight.log_evidence; }
};

}  // namespace

struct TopologyFilter::State {
  State(const TopologyConfig& topology_config, std::uint64_t random_seed, int threads)
      : config(topology_config), seed(random_seed), pool(threads), log(topology_config) {}

  TopologyConfig config;
  std::uint64_t seed;
  WorkerPool pool;
  VisitLog log;
  std::vector<Hypothesis> posterior;
  std::vector<std::vector<Eigen::Matrix3d>> newest_covariances;  // of each hypothesis
  TopologyCounts counts;

  [[nodiscard]] DrawKey draw_key() const { return {seed, log.size()}; }
  void begin();
  void grow();
  [[nodiscard]] std::vector<Candidate> candidates_of(std::size_t parent, int times,
                                                     std::uint32_t first);
  void leave_out_hopeless(std::vector<Candidate>& candidates) const;
  void settle(const std::vector<Candidate>& candidates);
  void propose_mergers(std::vector<Particle>& particles, std::vector<double>& log_weights);
  void keep(std::vector<Particle> particles, std::vector<double> log_weights);
  void keep_as_new();
};

void TopologyFilter::State::begin() {
  Hypothesis only;
  only.labels = {0};
  only.probability = 1.0;
  only.poses = {log.visit(0).odom_from_robot};
  only.gaussian = std::make_shared<const LocationGaussian>();
  posterior = {only};
  newest_covariances = {{Eigen::Matrix3d::Zero()}};
}

void TopologyFilter::State::grow() {
  const std::vector<int> times = choose_parents(posterior, config, draw_key());
  std::vector<std::uint32_t> first(times.size(), 0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    first[i] = first[i - 1] + static_cast<std::uint32_t>(times[i - 1]);
  }
  std::vector<std::vector<Candidate>> broods(posterior.size());
  pool.for_chunks(posterior.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    if (times[i] > 0) broods[i] = candidates_of(i, times[i], first[i]);
  });
  std::vector<Candidate> candidates;
  for (std::vector<Candidate>& brood : broods) {
    std::move(brood.begin(), brood.end(), std::back_inserter(candidates));
  }
  if (config.expansion == Expansion::kBest) leave_out_hopeless(candidates);
  counts.failed_matches = log.failed_matches();
  settle(candidates);
}

/// The labels that the copies of one parent follow.
std::vector<Candidate> TopologyFilter::State::candidates_of(std::size_t parent, int times,
                                                            std::uint32_t first) {
  const Hypothesis& hypothesis = posterior[parent];
  const OdometryFactor& odometry = log.measurements(log.size()).odometry.back();
  Prediction prediction(hypothesis.poses, *hypothesis.gaussian, odometry);
  const Children children = expand(hypothesis, prediction, newest_covariances[parent], log, config);
  const std::vector<Overlap> overlaps = find_overlaps(hypothesis, children, log);
  const double log_new_density = log.measurements(log.size()).log_new_density.back();
  std::vector<Candidate> candidates;
  for (const Choice& choice :
       choose_children(hypothesis, children, times, first, config, draw_key())) {
    const Child& child = children.children[choice.child];
    candidates.push_back({parent, child.label, choice.log_factor,
                          look(hypothesis, child, overlaps, prediction, config, log_new_density)});
  }
  return candidates;
}

/// Those that cannot be among the best even if linearizing did them wrong.
void TopologyFilter::State::leave_out_hopeless(std::vector<Candidate>& candidates) const {
  const auto kept = static_cast<std::size_t>(config.particles);
  if (candidates.size() <= kept) return;
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
  candidates = std::move(hopeful);
}

/// Optimizes every candidate and keeps the best.
void TopologyFilter::State::settle(const std::vector<Candidate>& candidates) {
  std::vector<std::optional<Particle>> settled(candidates.size());
  std::vector<double> log_weights(candidates.size(), 0.0);
  pool.for_chunks(candidates.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Candidate& candidate = candidates[i];
    const Hypothesis& parent = posterior[candidate.parent];
    Hypothesis next{parent.labels, 0.0, 0.0, {}, parent.scans, nullptr};
    next.labels.push_back(candidate.label);
    if (candidate.sight.scan) next.scans.push_back(*candidate.sight.scan);
    Evidence evidence = evaluate(next.labels, log.measurements(log.size()), next.scans,
                                 candidate.sight.poses, config.location);
    if (!evidence.converged) return;
    log_weights[i] = candidate.log_factor + evidence.log_evidence;
    next.log_evidence = evidence.log_evidence;
    next.poses = std::move(evidence.poses);
    next.gaussian = std::move(evidence.gaussian);
    settled[i] = Particle{std::move(next), newest_covariances[candidate.parent]};
    settled[i]->newest_covariances.push_back(
        block_of(settled[i]->hypothesis.gaussian->covariance_with(log.size() - 1), log.size() - 1));
  });
  std::vector<Particle> particles;
  std::vector<double> weights;
  for (std::size_t i = 0; i < settled.size(); ++i) {
    if (!settled[i] || !std::isfinite(log_weights[i])) {
      ++counts.not_converged;
      continue;
    }
    particles.push_back(std::move(*settled[i]));
    weights.push_back(log_weights[i]);
  }
  if (particles.empty()) {
    keep_as_new();
  } else {
    if (config.expansion == Expansion::kBest) propose_mergers(particles, weights);
    keep(std::move(particles), std::move(weights));
  }
}

/// A landmark that was taken for a new one is the old one after all, once a loop that closed later
/// has brought the two together; no label of a later visit could say so any more.
void TopologyFilter::State::propose_mergers(std::vector<Particle>& particles,
                                            std::vector<double>& log_weights) {
  std::set<Labels> known;
  for (const Particle& particle : particles) known.insert(particle.hypothesis.labels);
  const std::vector<std::size_t> order = by_weight(particles, log_weights);
  std::vector<std::pair<std::size_t, Labels>> merged;  // from which particle
  for (std::size_t k = 0; k < order.size() && merged.size() < kMostMergers; ++k) {
    const Hypothesis& hypothesis = particles[order[k]].hypothesis;
    for (Labels& labels : mergers(hypothesis, config.location)) {
      if (known.insert(labels).second) merged.emplace_back(order[k], std::move(labels));
    }
  }
  std::vector<std::optional<Particle>> settled(merged.size());
  std::vector<double> weights(merged.size(), 0.0);
  pool.for_chunks(merged.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Particle& from = particles[merged[i].first];
    Hypothesis next{merged[i].second, 0.0, 0.0, {}, from.hypothesis.scans, nullptr};
    Evidence evidence = evaluate(next.labels, log.measurements(log.size()), next.scans,
                                 from.hypothesis.poses, config.location);
    if (!evidence.converged) return;
    weights[i] = log_weights[merged[i].first] + evidence.log_evidence -
                 from.hypothesis.log_evidence +
                 log_partition_prior(next.labels, config.concentration) -
                 log_partition_prior(from.hypothesis.labels, config.concentration);
    next.log_evidence = evidence.log_evidence;
    next.poses = std::move(evidence.poses);
    next.gaussian = std::move(evidence.gaussian);
    settled[i] = Particle{std::move(next), from.newest_covariances};
  });
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (!settled[i] || !std::isfinite(weights[i])) continue;
    particles.push_back(std::move(*settled[i]));
    log_weights.push_back(weights[i]);
  }
}

/// Sorts by weight, keeps as many as the config says, and normalizes.
void TopologyFilter::State::keep(std::vector<Particle> particles, std::vector<double> log_weights) {
  std::vector<std::size_t> order = by_weight(particles, log_weights);
  if (order.size() > static_cast<std::size_t>(config.particles)) {
    order.resize(static_cast<std::size_t>(config.particles));
  }
  std::vector<double> kept;
  for (const std::size_t i : order) kept.push_back(log_weights[i]);
  const double log_total = log_sum_of(kept);
  posterior.clear();
  newest_covariances.clear();
  for (const std::size_t i : order) {
    particles[i].hypothesis.probability = std::exp(log_weights[i] - log_total);
    posterior.push_back(std::move(particles[i].hypothesis));
    newest_covariances.push_back(std::move(particles[i].newest_covariances));
  }
}

/// Nothing could be evaluated: the visit is held to be a new landmark where the odometry leads, so
/// that the posterior stays what it was before. The Gaussian then is that of the odometry alone.
void TopologyFilter::State::keep_as_new() {
  const Measurements measurements = log.measurements(log.size());
  const OdometryFactor& odometry = measurements.odometry.back();
  Labels apart(log.size());
  std::vector<Pose2> way{posterior.front().poses.front()};
  for (std::size_t i = 0; i < apart.size(); ++i) {
    apart[i] = static_cast<int>(i);
    if (i > 0) way.push_back(way.back() * measurements.odometry[i - 1].mean);
  }
  LocationPriorConfig without_penalty = config.location;
  without_penalty.max_penalty = 0.0;
  const Evidence by_odometry = evaluate(apart, measurements, {}, way, without_penalty);
  for (std::size_t i = 0; i < posterior.size(); ++i) {
    Hypothesis& hypothesis = posterior[i];
    hypothesis.labels.push_back(landmark_count(hypothesis.labels));
    hypothesis.poses.push_back(hypothesis.poses.back() * odometry.mean);
    hypothesis.gaussian = by_odometry.gaussian;
    newest_covariances[i].push_back(newest_covariances[i].back() + odometry.covariance);
  }
}

TopologyFilter::TopologyFilter(const TopologyConfig& config, std::uint64_t seed, int threads) {
  require_valid(config, "topology");
  state_ = std::make_unique<State>(config, seed, threads);
}

TopologyFilter::~TopologyFilter() = default;

bool TopologyFilter::add(LandmarkVisit visit) {
  State& s = *state_;
  if (!s.log.accepts(visit)) {
    ++s.counts.skipped_visits;
    return false;
  }
  s.counts.empty_patches += visit.patch.empty() ? 1 : 0;
  s.log.add(std::move(visit));
  if (s.log.size() == 1) {
    s.begin();
  } else {
    s.grow();
  }
  return true;
}

const std::vector<Hypothesis>& TopologyFilter::posterior() const { return state_->posterior; }

std::vector<Pose2Gaussian> TopologyFilter::locations(const Hypothesis& hypothesis) const {
  const std::vector<Eigen::Matrix3d> covariances = marginal_covariances(*hypothesis.gaussian);
  std::vector<Pose2Gaussian> locations;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    locations.push_back({hypothesis.poses[i], covariances[i]});
  }
  return locations;
}

std::vector<TopologySummary> TopologyFilter::summaries(std::size_t most) const {
  std::vector<TopologySummary> summaries;
  for (const Hypothesis& hypothesis : state_->posterior) {
    if (summaries.size() == most) break;
    TopologySummary summary{hypothesis.probability, hypothesis.log_evidence, hypothesis.labels, {}};
    for (const std::size_t first : first_visits(hypothesis.labels)) {
      summary.landmarks.push_back(
          {hypothesis.poses[first], marginal_covariance(*hypothesis.gaussian, first)});
    }
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

std::size_t TopologyFilter::visits() const { return state_->log.size(); }
const TopologyCounts& TopologyFilter::counts() const { return state_->counts; }

}  // namespace strata::topology
