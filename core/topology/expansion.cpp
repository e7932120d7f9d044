// SPDX-License-Identifier: Apache-2.0
#include "core/topology/expansion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "core/topology/dirichlet_process.hpp"

namespace strata::topology {
namespace {

/// Standard deviations beyond which a landmark is out of reach.
constexpr double kReachSigmas = 6.0;
/// Distinct landmarks this near start from displaced places too: at distance zero the penalty has
/// no slope that could tell them apart.
constexpr double kTooNearM = 0.5;
constexpr double kDisplacementM = 2.0;
/// Local maps of a landmark that a new one is matched to: the first and the latest ones.
constexpr std::size_t kMaxPartners = 4;

/// Of the position, along its longest axis.
double largest_stddev(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix2d position = covariance.topLeftCorner<2, 2>();
  const double half_trace = 0.5 * position.trace();
  const double determinant = position.determinant();
  return std::sqrt(half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant)));
}

/// The best of the optima reached from the predicted pose, and beside it where another landmark
/// lies in the way.
Evidence best_evidence(const Labels& labels, const Measurements& measurements,
                       const Hypothesis& parent, const Pose2& predicted, bool is_new,
                       const LocationPriorConfig& config) {
  const auto from = [&](const Pose2& newest) {
    std::vector<Pose2> start = parent.poses;
    start.push_back(newest);
    return evaluate(labels, measurements, parent.scans, std::move(start), config);
  };
  Evidence best = from(predicted);
  const bool in_the_way =
      is_new && std::any_of(parent.poses.begin(), parent.poses.end(), [&](const Pose2& pose) {
        return translation_distance(pose, predicted) < kTooNearM;
      });
  if (!in_the_way) return best;
  for (const Eigen::Vector2d& offset :
       {Eigen::Vector2d(kDisplacementM, 0.0), Eigen::Vector2d(-kDisplacementM, 0.0),
        Eigen::Vector2d(0.0, kDisplacementM), Eigen::Vector2d(0.0, -kDisplacementM)}) {
    Evidence other = from({predicted.x + offset.x(), predicted.y + offset.y(), predicted.theta});
    const bool better =
        other.converged && (!best.converged || other.log_evidence > best.log_evidence);
    if (better) best = std::move(other);
  }
  return best;
}

double log_sum(const std::vector<Child>& children) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const Child& child : children) {
    highest = std::max(highest, child.log_prior + child.log_odometry);
  }
  double sum = 0.0;
  for (const Child& child : children) {
    sum += std::exp(child.log_prior + child.log_odometry - highest);
  }
  return highest + std::log(sum);
}

/// Visits of the newest visit's landmark that its local map is matched to.
std::vector<std::size_t> partners(const Labels& labels) {
  std::vector<std::size_t> visits;
  for (std::size_t i = 0; i + 1 < labels.size(); ++i) {
    if (labels[i] == labels.back()) visits.push_back(i);
  }
  if (visits.size() > kMaxPartners) {
    visits.erase(visits.begin() + 1, visits.end() - (kMaxPartners - 1));
  }
  return visits;
}

}  // namespace

Children expand(const Hypothesis& parent, std::span<const Eigen::Matrix3d> newest_covariances,
                const VisitLog& log, const TopologyConfig& config) {
  const std::size_t newest = parent.labels.size();
  const Measurements measurements = log.measurements(newest + 1);
  const OdometryFactor& odometry = measurements.odometry[newest - 1];
  const Pose2 predicted = parent.poses.back() * odometry.mean;
  const double lever_m = odometry.mean.translation().norm();
  const double own_m = largest_stddev(newest_covariances.back()) +
                       std::sqrt(odometry.covariance(0, 0)) +
                       std::sqrt(newest_covariances.back()(2, 2)) * lever_m;
  const std::vector<double> prior = label_prior(parent.labels, config.concentration);
  const std::vector<std::size_t> firsts = first_visits(parent.labels);
  Children result;
  double best = -std::numeric_limits<double>::infinity();
  Labels labels = parent.labels;
  labels.push_back(0);
  for (std::size_t label = 0; label < prior.size(); ++label) {
    const bool is_new = label == firsts.size();
    if (!is_new) {
      const std::size_t first = firsts[label];
      const double reach_m = kReachSigmas * (own_m + largest_stddev(newest_covariances[first]) +
                                             config.location.revisit_stddev_m);
      if (translation_distance(parent.poses[first], predicted) > reach_m) continue;
    }
    Child child;
    child.label = static_cast<int>(label);
    child.log_prior = std::log(prior[label]);
    labels.back() = child.label;
    child.evidence =
        best_evidence(labels, measurements, parent, predicted, is_new, config.location);
    if (!child.evidence.converged) {
      ++result.not_converged;
      continue;
    }
    child.log_odometry = child.evidence.log_evidence - parent.log_evidence;
    best = std::max(best, child.log_prior + child.log_odometry);
    result.children.push_back(std::move(child));
  }
  std::erase_if(result.children, [&](const Child& child) {
    return child.log_prior + child.log_odometry < best - config.negligible;
  });
  if (!result.children.empty()) result.log_normalizer = log_sum(result.children);
  return result;
}

std::optional<Grown> look(const Hypothesis& parent, const Child& child, VisitLog& log,
                          const TopologyConfig& config) {
  Grown grown{{}, child.evidence.newest_covariance};
  Hypothesis& next = grown.hypothesis;
  next.labels = parent.labels;
  next.labels.push_back(child.label);
  next.scans = parent.scans;
  next.log_evidence = child.evidence.log_evidence;
  next.poses = child.evidence.poses;
  const std::size_t newest = parent.labels.size();
  std::optional<ScanFactor> factor;
  for (const std::size_t visit : partners(next.labels)) {
    if (log.visit(visit).patch.empty() || log.visit(newest).patch.empty()) continue;
    const PlaceMatch match =
        log.match(visit, newest, between(next.poses[visit], next.poses[newest]));
    if (!factor || match.gain > factor->match.gain) factor = ScanFactor{visit, newest, match};
  }
  if (!factor) return grown;
  next.scans.push_back(*factor);
  Evidence evidence = evaluate(next.labels, log.measurements(newest + 1), next.scans,
                               child.evidence.poses, config.location);
  if (!evidence.converged) return std::nullopt;
  next.log_evidence = evidence.log_evidence;
  next.poses = std::move(evidence.poses);
  grown.newest_covariance = evidence.newest_covariance;
  return grown;
}

}  // namespace strata::topology
