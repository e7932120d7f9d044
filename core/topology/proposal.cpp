// SPDX-License-Identifier: Apache-2.0
#include "core/topology/proposal.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random/stream.hpp"
#include "core/topology/detail/near_pairs.hpp"
#include "core/topology/dirichlet_process.hpp"

namespace strata::topology {
namespace {

constexpr std::uint32_t kResampleIndex = 0xFFFFFFFFU;
/// Landmarks within so many standard deviations of a revisit may be one: further apart the density
/// of a revisit is below that of a landmark anywhere in a building.
constexpr double kMergeStddevs = 4.0;
/// A visit within so many of its landmark belongs there, if no other is nearer.
constexpr double kNearStddevs = 2.0;

/// The index whose share of the sum a place in [0, 1) falls into; never one without a share.
std::size_t index_at(double place, const std::vector<double>& shares) {
  const double at = place * std::accumulate(shares.begin(), shares.end(), 0.0);
  double sum = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares[i] <= 0.0) continue;
    last = i;
    sum += shares[i];
    if (at < sum) break;
  }
  return last;
}

}  // namespace

std::vector<std::vector<double>> choose_parents(const std::vector<Hypothesis>& posterior,
                                                const TopologyConfig& config, const DrawKey& key) {
  std::vector<std::vector<double>> places(posterior.size());
  if (config.expansion == Expansion::kBest) {
    places.assign(posterior.size(), {0.0});
    return places;
  }
  RandomStream random(key.seed, StreamId::kTopology, key.visits, kResampleIndex);
  const double first = random.uniform();
  double before = 0.0;
  int drawn = 0;
  for (std::size_t i = 0; i < posterior.size(); ++i) {
    const double share = posterior[i].probability;
    const bool last = i + 1 == posterior.size();
    for (; drawn < config.particles; ++drawn) {
      const double place = (drawn + first) / config.particles;
      if (place >= before + share && !last) break;
      const double within = share > 0.0 ? (place - before) / share : 0.0;
      places[i].push_back(std::clamp(within, 0.0, std::nextafter(1.0, 0.0)));
    }
    before += share;
  }
  return places;
}

std::vector<Choice> choose_children(const Hypothesis& parent, const Children& children,
                                    const std::vector<double>& places,
                                    const TopologyConfig& config) {
  std::vector<Choice> choices;
  if (config.expansion == Expansion::kBest) {
    for (std::size_t c = 0; c < children.children.size(); ++c) {
      choices.push_back(
          {c, std::log(parent.probability) + children.children[c].log_prior - parent.log_evidence});
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
    proposal = label_prior(parent.labels, config.concentration);
  }
  std::vector<int> drawn(proposal.size(), 0);
  for (const double place : places) ++drawn[index_at(place, proposal)];
  for (std::size_t c = 0; c < children.children.size(); ++c) {
    const Child& child = children.children[c];
    const int count = drawn[with_odometry ? c : static_cast<std::size_t>(child.label)];
    if (count == 0) continue;
    double log_factor = std::log(static_cast<double>(count));
    if (!with_odometry) {
      log_factor -= parent.log_evidence;
    } else {
      log_factor -= parent.log_evidence + child.log_odometry;
      if (config.weighting == Weighting::kCorrected) log_factor += children.log_normalizer;
    }
    choices.push_back({c, log_factor});
  }
  return choices;
}

std::vector<Labels> mergers(const Hypothesis& hypothesis, const LocationPriorConfig& config) {
  std::vector<Labels> merged;
  const double reach_m = kMergeStddevs * config.revisit_stddev_m;
  const std::vector<std::size_t> firsts = first_visits(hypothesis.labels);
  for (const detail::Pair& pair : detail::near_pairs(firsts, hypothesis.poses, 1.01 * reach_m)) {
    if (translation_distance(hypothesis.poses[pair.a], hypothesis.poses[pair.b]) > reach_m) {
      continue;
    }
    Labels labels = hypothesis.labels;
    std::replace(labels.begin(), labels.end(), hypothesis.labels[pair.b],
                 hypothesis.labels[pair.a]);
    merged.push_back(canonical(labels));
  }
  return merged;
}

std::vector<Labels> moved_visits(const Hypothesis& hypothesis, const LocationPriorConfig& config) {
  std::vector<Labels> moved;
  const std::vector<std::size_t> firsts = first_visits(hypothesis.labels);
  for (std::size_t visit = 1; visit < hypothesis.labels.size(); ++visit) {
    const int own = hypothesis.labels[visit];
    if (firsts[static_cast<std::size_t>(own)] == visit) continue;
    const Pose2& at = hypothesis.poses[visit];
    const double own_m =
        translation_distance(at, hypothesis.poses[firsts[static_cast<std::size_t>(own)]]);
    int nearest = own;
    double nearest_m = own_m;
    for (int label = 0; label < static_cast<int>(firsts.size()); ++label) {
      const Pose2& landmark = hypothesis.poses[firsts[static_cast<std::size_t>(label)]];
      if (std::abs(landmark.x - at.x) >= nearest_m) continue;  // of a thousand most
      const double away_m = translation_distance(at, landmark);
      if (!(away_m < nearest_m)) continue;
      nearest = label;
      nearest_m = away_m;
    }
    Labels labels = hypothesis.labels;
    if (nearest != own) {
      labels[visit] = nearest;
      moved.push_back(canonical(labels));
    }
    if (own_m <= kNearStddevs * config.revisit_stddev_m) continue;
    labels[visit] = static_cast<int>(firsts.size());
    moved.push_back(canonical(labels));
  }
  return moved;
}

}  // namespace strata::topology
