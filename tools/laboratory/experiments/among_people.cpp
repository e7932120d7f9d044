// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/among_people.hpp"

#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "core/scan/endpoints.hpp"
#include "tools/laboratory/experiments/simulated_slam.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::experiments {
namespace {

using simulate::BeamSource;
using simulate::Simulation;

/// A walker who passes leaves this much, a shade in the picture; an obstacle is 0.25.
constexpr float kGhost = 0.05F;

/// What became of the beams: precision and recall of "dynamic" against "hit a person".
void judge_beams(const Simulation& simulation, const slam::SlamResult& result,
                 PeopleOutcome& outcome) {
  std::size_t called = 0;
  std::size_t found = 0;
  for (std::size_t t = 0; t < result.scans.size(); ++t) {
    const auto& sources = simulation.days[0].scans[t].sources;
    for (std::size_t n = 0; n < sources.size(); ++n) {
      if (sources[n] == BeamSource::kNothing) continue;
      const bool person = sources[n] == BeamSource::kPerson;
      const bool dynamic = result.scans[t].static_probability[n] < 0.5F;
      outcome.person_beams += person ? 1 : 0;
      called += dynamic ? 1 : 0;
      found += person && dynamic ? 1 : 0;
    }
  }
  outcome.precision = static_cast<double>(found) / static_cast<double>(called);
  outcome.recall = static_cast<double>(found) / static_cast<double>(outcome.person_beams);
}

/// What became of the map. A cell is spurious when only people were hit in it, and a wall's when
/// only still things were: told from the beams that end there, at the poses that were found.
void judge_map(const Simulation& simulation, const slam::SlamResult& result,
               PeopleOutcome& outcome) {
  struct Hits {
    std::size_t people = 0;
    std::size_t still = 0;
  };
  Grid<Hits> hits(result.occupancy.resolution_m(), result.occupancy.rect(), Hits{});
  for (std::size_t t = 0; t < result.scans.size(); ++t) {
    const PosedScan& posed = result.scans[t];
    const simulate::SimulatedScan& simulated = simulation.days[0].scans[t];
    const Endpoints ends = endpoints_in_robot(posed.scan);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Cell cell =
          hits.cell_at(posed.map_from_robot * Eigen::Vector2d(ends.x_m[i], ends.y_m[i]));
      if (!hits.contains(cell)) continue;
      const bool person = simulated.sources[ends.beam[i]] == BeamSource::kPerson;
      ++(person ? hits.at(cell).people : hits.at(cell).still);
    }
  }
  std::size_t lost = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hits& here = hits.values()[i];
    const float raw = result.occupancy.values()[i];
    const float filtered = result.filtered.get(hits.cell(i));
    if (here.people > 0 && here.still == 0) {
      outcome.spurious_raw += raw >= kGhost ? 1 : 0;
      outcome.spurious_filtered += filtered >= kGhost ? 1 : 0;
      outcome.obstacles_raw += is_occupied(raw) ? 1 : 0;
      outcome.obstacles_filtered += is_occupied(filtered) ? 1 : 0;
    } else if (here.people == 0 && is_occupied(raw)) {
      ++outcome.wall_cells;
      lost += is_occupied(filtered) ? 0 : 1;
    }
  }
  outcome.walls_lost = static_cast<double>(lost) / static_cast<double>(outcome.wall_cells);
}

/// SLAM that is sure of every beam: all else is the same.
slam::SlamConfig without_filter() {
  slam::SlamConfig config;
  config.beam_filter.prior = 1.0 - 1e-9;
  return config;
}

void print(const PeopleOutcome& outcome, std::size_t people, std::uint64_t seed) {
  std::cout << people << " people, seed " << seed << ": " << outcome.person_beams
            << " beams on people, precision " << outcome.precision << ", recall " << outcome.recall
            << ", spurious cells " << outcome.spurious_raw << " -> " << outcome.spurious_filtered
            << " (obstacles " << outcome.obstacles_raw << " -> " << outcome.obstacles_filtered
            << "), wall cells lost " << outcome.walls_lost << " of " << outcome.wall_cells
            << ", mean pose error " << outcome.pose_error_m << " m\n";
}

void compare_with_and_without(const std::filesystem::path& scenario, std::size_t people,
                              std::uint64_t first, std::uint64_t last, shards::Units& units) {
  std::vector<double> with_m;
  std::vector<double> without_m;
  std::vector<double> gain_m;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const std::string name = scenario.filename().string() + ", " + std::to_string(people) +
                             " people, seed " + std::to_string(seed);
    const auto [with, without] = units.of<std::pair<double, double>>(name, [&] {
      const Simulation simulation = drive_among(scenario, people, seed);
      const std::vector<Pose2> truth = true_poses(simulation);
      const auto error_m = [&](const slam::SlamConfig& config) {
        return aligned_error_m(found_poses(learn_first_day(simulation, config)), truth);
      };
      return std::pair(error_m({}), error_m(without_filter()));
    });
    with_m.push_back(with);
    without_m.push_back(without);
    gain_m.push_back(without_m.back() - with_m.back());
    std::cout << "seed " << seed << ": " << with_m.back() << " with, " << without_m.back()
              << " without\n";
  }
  const statistics::Interval interval = statistics::bootstrap_mean(gain_m, 0.95, 1);
  std::cout << scenario.filename().string() << ", " << people << " people: mean pose error "
            << statistics::mean(with_m) << " m with the filter, " << statistics::mean(without_m)
            << " without; less by " << statistics::mean(gain_m) << " m (" << interval.low << " to "
            << interval.high << "), p = " << statistics::wilcoxon_signed_rank(gain_m) << "\n";
}

}  // namespace

Simulation drive_among(const std::filesystem::path& scenario, std::size_t people,
                       std::uint64_t seed) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario);
  config.people.resize(people);
  return simulate::simulate(config, seed);
}

PeopleOutcome learn_among(const std::filesystem::path& scenario, std::size_t people,
                          std::uint64_t seed) {
  const Simulation simulation = drive_among(scenario, people, seed);
  const slam::SlamResult result = learn_first_day(simulation);
  PeopleOutcome outcome;
  outcome.pose_error_m = aligned_error_m(found_poses(result), true_poses(simulation));
  judge_beams(simulation, result, outcome);
  judge_map(simulation, result, outcome);
  return outcome;
}

void report_people(const std::filesystem::path& scenarios, std::uint64_t first, int seeds,
                   shards::Units& units) {
  for (const std::size_t people : {1U, 3U, 5U, 10U}) {
    std::size_t raw = 0;
    std::size_t filtered = 0;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(seeds); ++seed) {
      const auto outcome = units.of<PeopleOutcome>(
          std::to_string(people) + " people, seed " + std::to_string(seed),
          [&] { return learn_among(scenarios / "corridor_people.yaml", people, seed); });
      print(outcome, people, seed);
      raw += outcome.spurious_raw;
      filtered += outcome.spurious_filtered;
    }
    std::cout << people << " people: " << raw << " -> " << filtered << " spurious cells\n";
  }
}

void report_filter_against_none(const std::filesystem::path& scenarios, std::uint64_t first,
                                int seeds, shards::Units& units) {
  for (const char* world : {"corridor_people.yaml", "corridor_endless.yaml"}) {
    for (const std::size_t people : {0U, 5U, 10U}) {
      compare_with_and_without(scenarios / world, people, first,
                               first + static_cast<std::uint64_t>(seeds) - 1, units);
    }
  }
}

}  // namespace strata::experiments
