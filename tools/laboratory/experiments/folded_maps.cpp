// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/folded_maps.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>

#include "tools/laboratory/experiments/hard_buildings.hpp"
#include "tools/laboratory/experiments/simulated_slam.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr std::size_t kEvery = 5;
constexpr double kSamePlace_m = 2.0;
constexpr double kApart_m = 10.0;
constexpr double kWronglyFar_m = 0.5;

/// Rows: folded or not; columns: told as consistent or not.
struct Told {
  int sound_consistent = 0;
  int sound_inconsistent = 0;
  int folded_consistent = 0;
  int folded_inconsistent = 0;
  void add(const FoldedMap& map) {
    const bool is_folded = map.revisits.is_folded();
    const bool is_consistent = map.is_consistent > 0.0;
    if (is_folded) ++(is_consistent ? folded_consistent : folded_inconsistent);
    if (!is_folded) ++(is_consistent ? sound_consistent : sound_inconsistent);
  }
};

void print(const std::string& name, const Told& told, const std::vector<double>& errors_m) {
  double sum_m = 0.0;
  for (const double error_m : errors_m) sum_m += error_m;
  std::printf(
      "%s: %zu buildings, mean error %.3f m, worst %.3f m; not folded %d, of them told as "
      "inconsistent %d; folded %d, of them told as consistent %d\n",
      name.c_str(), errors_m.size(), sum_m / static_cast<double>(errors_m.size()),
      *std::max_element(errors_m.begin(), errors_m.end()),
      told.sound_consistent + told.sound_inconsistent, told.sound_inconsistent,
      told.folded_consistent + told.folded_inconsistent, told.folded_consistent);
  std::fflush(stdout);
}

void print(const std::string& name, std::uint64_t seed, const FoldedMap& map) {
  std::printf(
      "  %s %llu: error %.3f m (odometry %.2f m), %.0f of %.0f pairs of scans wrong, worst %.2f m; "
      "%.0f of %.0f stretches contradict each other: %s\n",
      name.c_str(), static_cast<unsigned long long>(seed), map.error_m, map.odometry_error_m,
      map.revisits.wrong, map.revisits.pairs, map.revisits.worst_m, map.contradicting, map.compared,
      map.is_consistent > 0.0 ? "consistent" : "inconsistent");
}

using Building = simulate::ScenarioConfig (*)(std::uint64_t);

void report_kind(const std::string& name, Building building, const slam::SlamConfig& config,
                 const Seeds& seeds, shards::Units& units) {
  Told told;
  std::vector<double> errors_m;
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const FoldedMap map = units.of<FoldedMap>(name + ", seed " + std::to_string(seed), [&] {
      return map_building(building(seed), seed, config);
    });
    if (!units.is_whole()) continue;
    told.add(map);
    errors_m.push_back(map.error_m);
    if (map.revisits.is_folded() || map.is_consistent == 0.0) print(name, seed, map);
  }
  if (!errors_m.empty()) print(name, told, errors_m);
}

}  // namespace

Revisits judge_revisits(const std::vector<Pose2>& found, const std::vector<Pose2>& truth) {
  std::vector<double> way_m(truth.size(), 0.0);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    way_m[i] = way_m[i - 1] + translation_distance(truth[i - 1], truth[i]);
  }
  Revisits result;
  for (std::size_t i = 0; i < truth.size(); i += kEvery) {
    for (std::size_t j = i + kEvery; j < truth.size(); j += kEvery) {
      if (way_m[j] - way_m[i] < kApart_m ||
          translation_distance(truth[i], truth[j]) > kSamePlace_m) {
        continue;
      }
      const double off_m =
          translation_distance(between(found[i], found[j]), between(truth[i], truth[j]));
      result.pairs += 1.0;
      result.wrong += off_m > kWronglyFar_m ? 1.0 : 0.0;
      result.worst_m = std::max(result.worst_m, off_m);
    }
  }
  return result;
}

slam::SlamConfig without_closures() {
  slam::SlamConfig config;
  config.closure.enabled = false;
  config.em.match_again = false;
  config.em.track_again = false;
  return config;
}

FoldedMap map_building(const simulate::ScenarioConfig& building, std::uint64_t seed,
                       const slam::SlamConfig& config) {
  const simulate::Simulation simulation = simulate::simulate(building, seed);
  const slam::SlamResult mapped = learn_first_day(simulation, config);
  const std::vector<Pose2> found = found_poses(mapped);
  const std::vector<Pose2> truth = true_poses(simulation);
  std::vector<Pose2> odometry;
  for (const auto& scan : simulation.days[0].scans) {
    odometry.push_back(scan.observation.odom_from_robot);
  }
  FoldedMap map;
  map.error_m = aligned_error_m(found, truth);
  map.odometry_error_m = aligned_error_m(odometry, truth);
  map.contradicting = static_cast<double>(mapped.consistency.contradicting);
  map.compared = static_cast<double>(mapped.consistency.compared);
  map.is_consistent = mapped.consistency.consistent ? 1.0 : 0.0;
  map.revisits = judge_revisits(found, truth);
  return map;
}

void report_folded_maps(const Seeds& seeds, shards::Units& units) {
  const std::array<std::pair<const char*, Building>, 4> kinds{{{"ring of rooms", ring_of_rooms},
                                                               {"long corridor", long_corridor},
                                                               {"hall of pillars", hall_of_pillars},
                                                               {"floor", poor_odometry_floor}}};
  for (const auto& [kind, building] : kinds) {
    for (const bool has_closures : {true, false}) {
      report_kind(std::string(kind) + (has_closures ? "" : ", scan matching alone"), building,
                  has_closures ? slam::SlamConfig{} : without_closures(), seeds, units);
    }
  }
}

}  // namespace strata::experiments
