// SPDX-License-Identifier: Apache-2.0
#include "core/topology/expansion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/LU>

#include "core/base/log_sum.hpp"
#include "core/topology/dirichlet_process.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology {
namespace {

/// Distinct landmarks this near start from displaced places too: at distance zero the penalty has
/// no slope that could tell them apart.
constexpr double kTooNearM = 0.5;
constexpr double kDisplacementM = 2.0;
/// Local clouds of a landmark that a new one is matched to: the first and the latest ones.
constexpr std::size_t kMaxPartners = 4;
constexpr int kPushSteps = 20;
/// Standard deviations of a revisit from which on two visits may be of two places.
constexpr double kApart = 2.0;
/// Squared standard deviations beyond which a landmark is out of reach.
constexpr double kReachSquared = 80.0;

/// Of a new landmark among known ones: where it comes to lie, and what the penalties cost.
struct Pushed {
  Eigen::Vector2d at_m{0.0, 0.0};
  double log_factor = -std::numeric_limits<double>::infinity();
};

struct PenaltySum {
  double value = 0.0;
  Eigen::Vector2d slope{0.0, 0.0};
  Eigen::Matrix2d curve = Eigen::Matrix2d::Zero();
};

/// Sum of the penalties of a landmark at a place, with derivatives by it.
PenaltySum penalties_at(const Eigen::Vector2d& at, std::span<const Eigen::Vector2d> others,
                        const LocationPriorConfig& config) {
  PenaltySum sum;
  for (const Eigen::Vector2d& other : others) {
    const Eigen::Vector2d apart = at - other;
    const double distance_m = apart.norm();
    const Penalty penalty = penalty_at(distance_m, config);
    sum.value += penalty.value;
    if (distance_m < 1e-6) {
      sum.curve += penalty.curve * Eigen::Matrix2d::Identity();
      continue;
    }
    const Eigen::Vector2d along = apart / distance_m;
    const Eigen::Matrix2d radial = along * along.transpose();
    sum.slope += penalty.slope * along;
    sum.curve += penalty.curve * radial +
                 penalty.slope / distance_m * (Eigen::Matrix2d::Identity() - radial);
  }
  return sum;
}

/// Laplace's method in the plane: the Gaussian around `mean` times exp(-penalties), from `start`.
Pushed push(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance,
            const Eigen::Vector2d& start, std::span<const Eigen::Vector2d> others,
            const LocationPriorConfig& config) {
  const Eigen::Matrix2d information = covariance.inverse();
  const auto cost = [&](const Eigen::Vector2d& at, const PenaltySum& sum) {
    return 0.5 * (at - mean).dot(information * (at - mean)) + sum.value;
  };
  Eigen::Vector2d at = start;
  PenaltySum sum = penalties_at(at, others, config);
  for (int i = 0; i < kPushSteps; ++i) {
    const Eigen::Vector2d gradient = information * (at - mean) + sum.slope;
    Eigen::Matrix2d curve = information + sum.curve;
    if (curve.determinant() <= 0.0 || curve.trace() <= 0.0) curve = information;
    const Eigen::Vector2d step = -curve.inverse() * gradient;
    double share = 1.0;
    Eigen::Vector2d next = at + step;
    PenaltySum next_sum = penalties_at(next, others, config);
    while (share > 1e-3 && cost(next, next_sum) > cost(at, sum)) {
      share *= 0.5;
      next = at + share * step;
      next_sum = penalties_at(next, others, config);
    }
    const bool converged = share * step.norm() < 1e-3;
    if (cost(next, next_sum) > cost(at, sum)) break;
    at = next;
    sum = next_sum;
    if (converged) break;
  }
  const double bent = (Eigen::Matrix2d::Identity() + covariance * sum.curve).determinant();
  return {at, -cost(at, sum) - (bent > 0.0 ? 0.5 * std::log(bent) : 0.0)};
}

/// ln of what a new landmark's penalties leave, and the poses then. The other landmarks are held:
/// an estimate.
Child new_landmark(const Hypothesis& parent, Prediction& prediction,
                   std::span<const std::size_t> firsts, const LocationPriorConfig& config) {
  Child child;
  child.poses = parent.poses;
  child.poses.push_back(prediction.newest());
  const Eigen::Vector2d mean = prediction.newest().translation();
  std::vector<Eigen::Vector2d> others;
  std::size_t nearest = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const std::size_t first : firsts) {
    const Eigen::Vector2d other = parent.poses[first].translation();
    const double distance_m = (mean - other).norm();
    if (distance_m < 2.0 * config.penalty_radius_m) others.push_back(other);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    nearest = first;
  }
  if (others.empty() || config.max_penalty <= 0.0) return child;
  const Eigen::Matrix2d covariance = prediction.covariance_apart(nearest);
  Pushed best = push(mean, covariance, mean, others, config);
  if (nearest_m < kTooNearM) {
    for (const Eigen::Vector2d& offset :
         {Eigen::Vector2d(kDisplacementM, 0.0), Eigen::Vector2d(-kDisplacementM, 0.0),
          Eigen::Vector2d(0.0, kDisplacementM), Eigen::Vector2d(0.0, -kDisplacementM)}) {
      const Pushed other = push(mean, covariance, mean + offset, others, config);
      if (other.log_factor > best.log_factor) best = other;
    }
  }
  child.log_odometry = best.log_factor;
  child.poses.back().x = best.at_m.x();
  child.poses.back().y = best.at_m.y();
  return child;
}

/// ln of the constants of a revisit: position Gaussian, heading uniform.
double log_revisit_constant(const LocationPriorConfig& config) {
  return -2.0 * std::log(2.0 * std::numbers::pi * config.revisit_stddev_m);
}

/// Whether the match shows another place from which the same walls are seen: their maps fit, well
/// apart. One that fits in place looks the same, and either is the same or says nothing.
bool is_neighbour(const PlaceMatch& match, const LocationPriorConfig& config) {
  return match.gain > 0.0 && match.a_from_b.translation().norm() > kApart * config.revisit_stddev_m;
}

/// What a new landmark at this pose would cost, the others held.
double penalty_of_newest(const Hypothesis& parent, std::span<const std::size_t> firsts,
                         const Pose2& newest, const LocationPriorConfig& config) {
  double sum = 0.0;
  for (const std::size_t first : firsts) {
    sum += penalty_at(translation_distance(parent.poses[first], newest), config).value;
  }
  return sum;
}

/// Visits of a landmark that the newest local cloud is matched to.
std::vector<std::size_t> partners(const Labels& labels, int label) {
  std::vector<std::size_t> visits;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == label) visits.push_back(i);
  }
  if (visits.size() > kMaxPartners) {
    visits.erase(visits.begin() + 1, visits.end() - (kMaxPartners - 1));
  }
  return visits;
}

}  // namespace

Children expand(const Hypothesis& parent, Prediction& prediction,
                std::span<const Eigen::Matrix3d> newest_covariances, const VisitLog& log,
                const TopologyConfig& config) {
  const std::size_t newest = parent.labels.size();
  const std::vector<double> prior = label_prior(parent.labels, config.concentration);
  const std::vector<std::size_t> firsts = first_visits(parent.labels);
  const Eigen::Vector2d predicted = prediction.newest().translation();
  const Eigen::Matrix2d place = config.location.revisit_stddev_m *
                                config.location.revisit_stddev_m * Eigen::Matrix2d::Identity();
  Children result;
  for (std::size_t label = 0; label < firsts.size(); ++label) {
    const std::size_t first = firsts[label];
    const Eigen::Vector2d apart = predicted - parent.poses[first].translation();
    const Eigen::Matrix2d bound =
        prediction.covariance_apart(first, newest_covariances[first]) + place;
    if (apart.dot(bound.inverse() * apart) > kReachSquared) continue;
    const LinearizedFactor factor = prediction.same_place_factor(first, config.location);
    Prediction::Conditioned conditioned = prediction.conditioned_on({&factor, 1});
    result.children.push_back({static_cast<int>(label), std::log(prior[label]),
                               conditioned.log_factor + log_revisit_constant(config.location),
                               std::move(conditioned.poses)});
  }
  Child fresh = new_landmark(parent, prediction, firsts, config.location);
  fresh.label = static_cast<int>(firsts.size());
  fresh.log_prior = std::log(prior.back());
  fresh.log_odometry += log.measurements(newest + 1).log_new_density[newest];
  result.children.push_back(std::move(fresh));
  const auto log_proposal = [](const Child& child) { return child.log_prior + child.log_odometry; };
  double best = -std::numeric_limits<double>::infinity();
  for (const Child& child : result.children) best = std::max(best, log_proposal(child));
  std::erase_if(result.children,
                [&](const Child& child) { return log_proposal(child) < best - config.negligible; });
  result.log_normalizer = log_sum_exp(result.children, log_proposal);
  return result;
}

std::vector<Overlap> find_overlaps(const Hypothesis& parent, const Children& children,
                                   const Pose2& newest_pose, VisitLog& log,
                                   const CloudMatchConfig& config) {
  std::vector<Overlap> overlaps;
  const std::size_t newest = parent.labels.size();
  if (log.visit(newest).cloud.empty()) return overlaps;
  for (const Child& child : children.children) {
    std::optional<ScanFactor> best;
    for (const std::size_t visit : partners(parent.labels, child.label)) {
      if (log.visit(visit).cloud.empty()) continue;
      PlaceMatch match = log.match(visit, newest, between(child.poses[visit], child.poses[newest]));
      if (match.gain < config.look_alike_gain) {
        const PlaceMatch other =
            log.match(visit, newest, between(parent.poses[visit], newest_pose));
        if (other.gain > match.gain) match = other;
      }
      if (best && match.gain <= best->match.gain) continue;
      best = ScanFactor{visit, newest, match};
    }
    if (!best) continue;
    best->match.gain = gain_over_look_alikes(best->match.gain, config);
    overlaps.push_back({child.label, *best});
  }
  return overlaps;
}

CandidateEvidence candidate_evidence(const Hypothesis& parent, const Child& child,
                                     std::span<const Overlap> overlaps, Prediction& prediction,
                                     const TopologyConfig& config, double log_new_density) {
  const std::vector<std::size_t> firsts = first_visits(parent.labels);
  const auto label = static_cast<std::size_t>(child.label);
  const bool is_new = label == firsts.size();
  CandidateEvidence unseen{std::nullopt, parent.log_evidence + child.log_odometry, child.poses};
  bool own_fits = false;
  double misfit = 0.0;  // of its own landmark's map: counts wherever the newest one is registered
  for (const Overlap& overlap : overlaps) {
    if (overlap.label != child.label) continue;
    own_fits = overlap.scan.match.converged;
    misfit = std::min(0.0, overlap.scan.match.gain);
    if (own_fits) continue;
    unseen.scan = overlap.scan;
    unseen.log_evidence += misfit;
  }
  std::optional<CandidateEvidence> best;
  for (const Overlap& overlap : overlaps) {
    const PlaceMatch& match = overlap.scan.match;
    if (!match.converged) continue;
    const bool own = overlap.label == child.label;
    if (!own && !is_neighbour(match, config.location)) continue;
    std::vector<LinearizedFactor> factors{prediction.registration_factor(overlap.scan.from, match)};
    if (!is_new) factors.push_back(prediction.same_place_factor(firsts[label], config.location));
    CandidateEvidence evidence{overlap.scan, parent.log_evidence, {}};
    if (!own) evidence.scan->match.gain += misfit;
    evidence.log_evidence += evidence.scan->match.gain;
    Prediction::Conditioned conditioned = prediction.conditioned_on(factors);
    evidence.log_evidence += conditioned.log_factor;
    evidence.log_evidence +=
        is_new ? log_new_density -
                     penalty_of_newest(parent, firsts, conditioned.poses.back(), config.location)
               : log_revisit_constant(config.location);
    evidence.poses = std::move(conditioned.poses);
    if (!best || evidence.log_evidence > best->log_evidence) best = std::move(evidence);
  }
  // Its own landmark's map is always looked at; another's only where that fits better.
  if (best && (own_fits || best->log_evidence > unseen.log_evidence)) return *best;
  return unseen;
}

}  // namespace strata::topology
