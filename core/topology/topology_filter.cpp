// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/random/stream.hpp"
#include "core/topology/dirichlet_process.hpp"
#include "core/topology/expansion.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {
namespace {

constexpr std::uint32_t kResampleIndex = 0xFFFFFFFFU;

/// One topology with what only the filter needs of it.
struct Particle {
  Hypothesis hypothesis;
  std::vector<Eigen::Matrix3d> newest_covariances;  ///< of each visit when it was new
};

/// One label to follow: the parent's share of particles, and by what looking multiplies it.
struct Choice {
  std::size_t child = 0;
  double log_factor = 0.0;  ///< weight before looking, less ln Z(L + j; odometry)
};

/// How often each hypothesis is taken when `count` are drawn by probability (systematic).
std::vector<int> draw_parents(const std::vector<Hypothesis>& posterior, int count,
                              RandomStream random) {
  std::vector<int> times(posterior.size(), 0);
  const double step = 1.0 / count;
  double next = random.uniform() * step;
  double sum = 0.0;
  for (std::size_t i = 0; i < posterior.size(); ++i) {
    sum += posterior[i].probability;
    const bool last = i + 1 == posterior.size();
    while (next < sum || (last && next < 1.0)) {
      ++times[i];
      next += step;
    }
  }
  return times;
}

double log_sum_of(const std::vector<double>& logs) {
  const double highest = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double value : logs) sum += std::exp(value - highest);
  return highest + std::log(sum);
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
  [[nodiscard]] std::vector<int> parents() const;
  [[nodiscard]] std::vector<Choice> choose(std::size_t parent, int times, std::uint32_t first,
                                           const Children& children) const;
  void keep(std::vector<Particle> particles, std::vector<double> log_weights);
  void keep_as_new();
};

void TopologyFilter::State::begin() {
  Hypothesis only;
  only.labels = {0};
  only.probability = 1.0;
  only.poses = {log.visit(0).odom_from_robot};
  posterior = {only};
  newest_covariances = {{Eigen::Matrix3d::Zero()}};
}

/// Every hypothesis once when the best are kept exactly; else drawn by probability.
std::vector<int> TopologyFilter::State::parents() const {
  if (config.expansion == Expansion::kBest) return std::vector<int>(posterior.size(), 1);
  return draw_parents(posterior, config.particles,
                      RandomStream(seed, StreamId::kTopology, log.size(), kResampleIndex));
}

/// The labels that the copies of a parent draw (or all of them, when the best are kept exactly),
/// each with the logarithm of its weight less ln Z(L + j; odometry).
std::vector<Choice> TopologyFilter::State::choose(std::size_t parent, int times,
                                                  std::uint32_t first,
                                                  const Children& children) const {
  std::vector<Choice> choices;
  const Hypothesis& hypothesis = posterior[parent];
  if (config.expansion == Expansion::kBest) {
    for (std::size_t c = 0; c < children.children.size(); ++c) {
      choices.push_back({c, std::log(hypothesis.probability) + children.children[c].log_prior -
                                hypothesis.log_evidence});
    }
    return choices;
  }
  const bool with_odometry = config.proposal == Proposal::kOdometry;
  std::vector<double> proposal;
  if (with_odometry) {
    for (const Child& child : children.children) {
      proposal.push_back(std::exp(child.log_prior + child.log_odometry - children.log_normalizer));
    }
  } else {
    proposal = label_prior(hypothesis.labels, config.concentration);
  }
  std::vector<int> drawn(proposal.size(), 0);
  for (int copy = 0; copy < times; ++copy) {
    RandomStream random(seed, StreamId::kTopology, log.size(),
                        first + static_cast<std::uint32_t>(copy));
    ++drawn[random.categorical(proposal)];
  }
  for (std::size_t c = 0; c < children.children.size(); ++c) {
    const Child& child = children.children[c];
    const int count = drawn[with_odometry ? c : static_cast<std::size_t>(child.label)];
    if (count == 0) continue;
    double log_factor = std::log(static_cast<double>(count));
    if (!with_odometry) {
      log_factor -= hypothesis.log_evidence;
    } else {
      log_factor -= child.evidence.log_evidence;
      if (config.weighting == Weighting::kCorrected) log_factor += children.log_normalizer;
    }
    choices.push_back({c, log_factor});
  }
  return choices;
}

void TopologyFilter::State::grow() {
  const std::vector<int> times = parents();
  std::vector<std::uint32_t> first(times.size(), 0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    first[i] = first[i - 1] + static_cast<std::uint32_t>(times[i - 1]);
  }
  struct Brood {
    std::vector<Particle> particles;
    std::vector<double> log_weights;
    std::size_t not_converged = 0;
  };
  std::vector<Brood> broods(posterior.size());
  pool.for_chunks(posterior.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    if (times[i] == 0) return;
    const Children children = expand(posterior[i], newest_covariances[i], log, config);
    Brood& brood = broods[i];
    brood.not_converged = children.not_converged;
    if (children.children.empty()) return;
    for (const Choice& choice : choose(i, times[i], first[i], children)) {
      std::optional<Grown> grown = look(posterior[i], children.children[choice.child], log, config);
      if (!grown) {
        ++brood.not_converged;
        continue;
      }
      brood.log_weights.push_back(choice.log_factor + grown->hypothesis.log_evidence);
      std::vector<Eigen::Matrix3d> covariances = newest_covariances[i];
      covariances.push_back(grown->newest_covariance);
      brood.particles.push_back({std::move(grown->hypothesis), std::move(covariances)});
    }
  });
  std::vector<Particle> particles;
  std::vector<double> log_weights;
  for (Brood& brood : broods) {
    counts.not_converged += brood.not_converged;
    for (std::size_t k = 0; k < brood.particles.size(); ++k) {
      if (!std::isfinite(brood.log_weights[k])) continue;
      particles.push_back(std::move(brood.particles[k]));
      log_weights.push_back(brood.log_weights[k]);
    }
  }
  counts.failed_matches = log.failed_matches();
  if (particles.empty()) {
    keep_as_new();
  } else {
    keep(std::move(particles), std::move(log_weights));
  }
}

/// Sorts by weight, keeps as many as the config says, and normalizes.
void TopologyFilter::State::keep(std::vector<Particle> particles, std::vector<double> log_weights) {
  std::vector<std::size_t> order(particles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (log_weights[a] != log_weights[b]) return log_weights[a] > log_weights[b];
    return particles[a].hypothesis.labels < particles[b].hypothesis.labels;
  });
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
/// that the posterior stays what it was before.
void TopologyFilter::State::keep_as_new() {
  const OdometryFactor& odometry = log.measurements(log.size()).odometry.back();
  for (std::size_t i = 0; i < posterior.size(); ++i) {
    Hypothesis& hypothesis = posterior[i];
    hypothesis.labels.push_back(landmark_count(hypothesis.labels));
    hypothesis.poses.push_back(hypothesis.poses.back() * odometry.mean);
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
  const std::vector<Eigen::Matrix3d> covariances =
      marginal_covariances(hypothesis.labels, state_->log.measurements(hypothesis.labels.size()),
                           hypothesis.scans, hypothesis.poses, state_->config.location);
  std::vector<Pose2Gaussian> locations;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    locations.push_back({hypothesis.poses[i], covariances[i]});
  }
  return locations;
}

std::size_t TopologyFilter::visits() const { return state_->log.size(); }
const TopologyCounts& TopologyFilter::counts() const { return state_->counts; }

}  // namespace strata::topology
