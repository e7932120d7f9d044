// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/topology_trial.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/topology/partition.hpp"
#include "core/topology/topology_mapper.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr double kSure = 0.8;

bool is_one_place(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a - b).norm() <= kOnePlace_m;
}

/// Nothing where three visits contradict each other: two of them within a metre of the third, but
/// not of each other.
std::optional<topology::Labels> true_partition(std::span<const Eigen::Vector2d> places_m) {
  topology::Labels labels;
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    labels.push_back(static_cast<int>(i));
    for (std::size_t k = 0; k < i; ++k) {
      if (!is_one_place(places_m[k], places_m[i])) continue;
      labels[i] = labels[k];
      break;
    }
  }
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (is_one_place(places_m[k], places_m[i]) != (labels[i] == labels[k])) return std::nullopt;
    }
  }
  return topology::canonical(labels);
}

/// The true places of the visits, in the map of the simulation.
class TruePlaces {
 public:
  explicit TruePlaces(const simulate::SimulatedDay& day) {
    for (const simulate::SimulatedScan& scan : day.scans) {
      poses_.emplace(scan.observation.scan.stamp, scan.map_from_robot);
    }
  }
  [[nodiscard]] Eigen::Vector2d of(const topology::MadeVisit& visit) const {
    return (poses_.at(visit.visit.stamp) * visit.robot_from_visit).translation();
  }

 private:
  std::map<Stamp, Pose2> poses_;
};

}  // namespace

void Reliability::add(double probability, bool is_one_place) {
  const auto above =
      std::upper_bound(kProbabilityBins.begin() + 1, kProbabilityBins.end() - 1, probability);
  ReliabilityBin& bin = bins[static_cast<std::size_t>(above - kProbabilityBins.begin()) - 1];
  bin.pairs += 1.0;
  bin.probability += probability;
  bin.one_place += is_one_place ? 1.0 : 0.0;
}

Reliability& Reliability::operator+=(const Reliability& other) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].pairs += other.bins[i].pairs;
    bins[i].probability += other.bins[i].probability;
    bins[i].one_place += other.bins[i].one_place;
  }
  return *this;
}

double Reliability::pairs() const {
  double sum = 0.0;
  for (const ReliabilityBin& bin : bins) sum += bin.pairs;
  return sum;
}

double Reliability::worst_error(double least_pairs) const {
  double worst = 0.0;
  for (const ReliabilityBin& bin : bins) {
    if (bin.pairs == 0.0 || bin.pairs < least_pairs) continue;
    const double error = (bin.one_place - bin.probability) / bin.pairs;
    if (std::abs(error) > std::abs(worst)) worst = error;
  }
  return worst;
}

double Reliability::mean_error() const {
  double sum = 0.0;
  for (const ReliabilityBin& bin : bins) sum += std::abs(bin.one_place - bin.probability);
  return sum / std::max(1.0, pairs());
}

TopologyTrial& TopologyTrial::operator+=(const TopologyTrial& other) {
  for (double TopologyTrial::*sum :
       {&TopologyTrial::buildings, &TopologyTrial::visits, &TopologyTrial::partitions,
        &TopologyTrial::truth_first, &TopologyTrial::truth_sure, &TopologyTrial::truth_mass,
        &TopologyTrial::largest_mass}) {
    this->*sum += other.*sum;
  }
  at_end += other.at_end;
  when_new += other.when_new;
  return *this;
}

double one_landmark(std::span<const topology::Hypothesis> posterior, std::size_t a, std::size_t b) {
  double probability = 0.0;
  for (const topology::Hypothesis& hypothesis : posterior) {
    if (hypothesis.labels[a] == hypothesis.labels[b]) probability += hypothesis.probability;
  }
  return std::min(1.0, probability);
}

void judge_posterior(std::span<const Eigen::Vector2d> places_m,
                     std::span<const topology::Hypothesis> posterior, TopologyTrial& trial) {
  for (std::size_t b = 1; b < places_m.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      trial.at_end.add(one_landmark(posterior, a, b), is_one_place(places_m[a], places_m[b]));
    }
  }
  const std::optional<topology::Labels> truth = true_partition(places_m);
  if (!truth || posterior.empty()) return;
  trial.partitions += 1.0;
  trial.largest_mass += posterior.front().probability;
  for (const topology::Hypothesis& hypothesis : posterior) {
    if (hypothesis.labels != *truth) continue;
    const bool is_first = &hypothesis == &posterior.front();
    trial.truth_mass += hypothesis.probability;
    trial.truth_first += is_first ? 1.0 : 0.0;
    trial.truth_sure += is_first && hypothesis.probability > kSure ? 1.0 : 0.0;
  }
}

TopologyTrial try_topologies(const simulate::ScenarioConfig& world, std::uint64_t seed,
                             const topology::TopologyMapperConfig& config) {
  const simulate::Simulation simulation = simulate::simulate(world, seed);
  const TruePlaces truth(simulation.days.front());
  topology::TopologyMapper mapper(config, seed);
  TopologyTrial trial;
  std::vector<Eigen::Vector2d> places_m;
  const auto take = [&](std::vector<topology::MadeVisit> visits) {
    for (topology::MadeVisit& visit : visits) {
      const Eigen::Vector2d place_m = truth.of(visit);
      if (!mapper.update(std::move(visit))) continue;
      for (std::size_t i = 0; i < places_m.size(); ++i) {
        trial.when_new.add(one_landmark(mapper.posterior(), i, places_m.size()),
                           is_one_place(places_m[i], place_m));
      }
      places_m.push_back(place_m);
    }
  };
  for (const simulate::SimulatedScan& scan : simulation.days.front().scans) {
    take(mapper.add(scan.observation));
  }
  take(mapper.finish());
  trial.buildings = 1.0;
  trial.visits = static_cast<double>(places_m.size());
  judge_posterior(places_m, mapper.posterior(), trial);
  return trial;
}

}  // namespace strata::experiments
