// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_filter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/log_sum.hpp"
#include "core/base/parallel.hpp"
#include "core/topology/detail/near_pairs.hpp"
#include "core/topology/expansion.hpp"
#include "core/topology/generation.hpp"
#include "core/topology/proposal.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {
namespace {

/// Two landmarks this near, or within two standard deviations of a revisit, may be one.
constexpr double kNearM = 1.0;

std::size_t count_near_landmarks(const Hypothesis& hypothesis, const LocationPriorConfig& config) {
  const double reach_m = std::max(kNearM, 2.0 * config.revisit_stddev_m);
  const std::vector<std::size_t> firsts = first_visits(hypothesis.labels);
  std::size_t count = 0;
  for (const detail::Pair& pair : detail::near_pairs(firsts, hypothesis.poses, 1.01 * reach_m)) {
    const double apart_m = translation_distance(hypothesis.poses[pair.a], hypothesis.poses[pair.b]);
    count += apart_m <= reach_m ? 1 : 0;
  }
  return count;
}

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

  void begin();
  void grow();
  [[nodiscard]] std::vector<Candidate> candidates_of(std::size_t parent,
                                                     const std::vector<double>& places);
  void keep(Generation generation);
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
  const std::vector<std::vector<double>> places =
      choose_parents(posterior, config, {seed, log.size()});
  std::vector<std::vector<Candidate>> expanded(posterior.size());
  pool.for_chunks(posterior.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    if (!places[i].empty()) expanded[i] = candidates_of(i, places[i]);
  });
  std::vector<Candidate> candidates;
  for (std::vector<Candidate>& part : expanded) {
    std::move(part.begin(), part.end(), std::back_inserter(candidates));
  }
  const bool best = config.expansion == Expansion::kBest;
  if (best) {
    candidates = prune(std::move(candidates), static_cast<std::size_t>(config.particles));
  }
  Generation generation =
      evaluate_candidates(candidates, {posterior, newest_covariances}, log, config, pool);
  counts.failed_matches = log.failed_matches();
  counts.not_converged += generation.not_converged;
  if (generation.particles.empty()) {
    counts.optimized += generation.optimized;
    keep_as_new();
    return;
  }
  if (best) add_revisions(generation, log, config, pool);
  counts.optimized += generation.optimized;
  keep(std::move(generation));
}

/// The labels that the particles of one parent follow.
std::vector<Candidate> TopologyFilter::State::candidates_of(std::size_t parent,
                                                            const std::vector<double>& places) {
  const Hypothesis& hypothesis = posterior[parent];
  const OdometryFactor& odometry = log.measurements(log.size()).odometry.back();
  Prediction prediction(hypothesis.poses, *hypothesis.gaussian, odometry);
  const Children children = expand(hypothesis, prediction, newest_covariances[parent], log, config);
  const std::vector<Overlap> overlaps =
      find_overlaps(hypothesis, children, prediction.newest(), log, config.match);
  const double log_new_density = log.measurements(log.size()).log_new_density.back();
  std::vector<Candidate> candidates;
  for (const Choice& choice : choose_children(hypothesis, children, places, config)) {
    const Child& child = children.children[choice.child];
    candidates.push_back(
        {parent, child.label, choice.log_factor,
         candidate_evidence(hypothesis, child, overlaps, prediction, config, log_new_density)});
  }
  return candidates;
}

/// Sorts by weight, keeps as many as the config says, and normalizes.
void TopologyFilter::State::keep(Generation generation) {
  std::vector<Particle>& particles = generation.particles;
  const std::vector<double>& log_weights = generation.log_weights;
  std::vector<std::size_t> order = by_weight(particles, log_weights);
  if (order.size() > static_cast<std::size_t>(config.particles)) {
    order.resize(static_cast<std::size_t>(config.particles));
  }
  std::vector<double> kept;
  for (const std::size_t i : order) kept.push_back(log_weights[i]);
  const double log_total = log_sum_exp(kept);
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
  if (!is_sound(visit)) {
    ++s.counts.broken_visits;
    return false;
  }
  if (!s.log.follows(visit.stamp)) {
    ++s.counts.late_visits;
    return false;
  }
  if (!is_sound(visit.cloud)) visit.cloud = {};
  s.counts.empty_clouds += visit.cloud.empty() ? 1 : 0;
  s.log.add(std::move(visit));
  if (s.log.size() == 1) {
    s.begin();
  } else {
    s.grow();
  }
  s.counts.near_landmarks = count_near_landmarks(s.posterior.front(), s.config.location);
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
