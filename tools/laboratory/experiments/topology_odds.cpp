// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/topology_odds.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "core/random/stream.hpp"
#include "tools/laboratory/experiments/corridor_building.hpp"
#include "tools/report/html_report.hpp"
#include "tools/simulate/random_floor.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr std::uint64_t kErrors = 6161;  // of the stream of worlds
constexpr double kEnoughPairs = 100.0;   // to say of a bin how far it is off
constexpr double kAllowedError = 0.03;   // of what it says
constexpr int kOfficeDays = 1;

simulate::ScenarioConfig corridors(std::uint64_t seed) {
  return corridor_building(random_corridors(seed));
}
simulate::ScenarioConfig office(std::uint64_t seed) {
  return simulate::random_office(seed, {.days = kOfficeDays, .has_change = false, .people = 0});
}
simulate::ScenarioConfig floor(std::uint64_t seed) {
  return simulate::random_floor(seed, {.days = kOfficeDays, .people = 0});
}

constexpr std::array<std::pair<const char*, simulate::ScenarioConfig (*)(std::uint64_t)>, 3> kKinds{
    {{"corridors that look alike", corridors},
     {"random offices", office},
     {"random floors", floor}}};

std::vector<std::vector<std::string>> rows_of(const Reliability& reliability) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < reliability.bins.size(); ++i) {
    const ReliabilityBin& bin = reliability.bins[i];
    if (bin.pairs == 0.0) continue;
    rows.push_back(
        {report::fixed(kProbabilityBins[i], 2) + " to " + report::fixed(kProbabilityBins[i + 1], 2),
         report::fixed(bin.pairs, 0), report::fixed(bin.probability / bin.pairs, 4),
         report::fixed(bin.one_place / bin.pairs, 4)});
  }
  return rows;
}

void print(const char* when, const Reliability& reliability) {
  std::printf("  %s, %.0f pairs: worst bin of at least %.0f pairs %+.3f (%.2f allowed), all %.4f\n",
              when, reliability.pairs(), kEnoughPairs, reliability.worst_error(kEnoughPairs),
              kAllowedError, reliability.mean_error());
  std::printf("  | p | pairs | mean p | of one place |\n  |---|---|---|---|\n");
  for (const auto& row : rows_of(reliability)) {
    std::printf("  | %s | %s | %s | %s |\n", row[0].c_str(), row[1].c_str(), row[2].c_str(),
                row[3].c_str());
  }
}

void print(const std::string& name, const TopologyTrial& trial) {
  const double known = std::max(1.0, trial.partitions);
  std::printf(
      "%s: %.0f buildings, %.0f visits; where the true partition is known (%.0f): its mass %.3f in "
      "the mean, that of the likeliest %.3f, the truth first in %.0f, with more than 80%% in "
      "%.0f\n",
      name.c_str(), trial.buildings, trial.visits, trial.partitions, trial.truth_mass / known,
      trial.largest_mass / known, trial.truth_first, trial.truth_sure);
  print("at the end", trial.at_end);
  print("when a visit is new", trial.when_new);
}

report::Series series_of(const std::string& name, const Reliability& reliability) {
  report::Series series{name, {}, {}};
  for (const ReliabilityBin& bin : reliability.bins) {
    if (bin.pairs < kEnoughPairs) continue;
    series.x.push_back(bin.probability / bin.pairs);
    series.y.push_back(bin.one_place / bin.pairs);
  }
  return series;
}

void add_to(report::HtmlReport& page, const std::string& name, const Reliability& reliability) {
  report::LinePlot plot{
      .title = "Said and true: " + name,
      .x_label = "probability that two visits are of one place",
      .y_label = "share of pairs that are",
      .series = {{"as said", {0.0, 1.0}, {0.0, 1.0}}, series_of(name, reliability)},
      .from_zero = true,
      .y_max = 1.0,
      .points = true};
  std::string file = "reliability_" + name;
  std::replace_if(
      file.begin(), file.end(), [](char c) { return c == ' ' || c == ','; }, '_');
  page.plot(file, plot, "Bins of at least 100 pairs.");
  page.table({{"p", "pairs", "mean p", "of one place"}, rows_of(reliability), name});
}

}  // namespace

void draw_odometry_error(std::uint64_t seed, simulate::RobotConfig& robot) {
  RandomStream random(seed, StreamId::kSimulatorWorld, kErrors);
  set_odometry_error(robot, random.uniform(0.05, 0.20));
}

void report_topologies(const Seeds& seeds, const std::filesystem::path& folder,
                       shards::Units& units) {
  std::vector<std::pair<std::string, TopologyTrial>> sums;
  TopologyTrial all;
  for (const auto& kind : kKinds) {
    const std::string name = kind.first;
    const auto world = kind.second;
    TopologyTrial sum;
    for (int i = 0; i < seeds.count; ++i) {
      const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
      sum += units.of<TopologyTrial>(name + ", seed " + std::to_string(seed), [world, seed] {
        simulate::ScenarioConfig building = world(seed);
        draw_odometry_error(seed, building.robot);
        return try_topologies(building, seed);
      });
    }
    all += sum;
    sums.emplace_back(name, sum);
  }
  if (!units.is_whole()) return;
  sums.emplace_back("all", all);
  std::filesystem::create_directories(folder);
  report::HtmlReport page(folder, "Odds of topologies");
  for (const auto& [name, sum] : sums) {
    print(name, sum);
    page.heading(name);
    add_to(page, name + ", at the end", sum.at_end);
    add_to(page, name + ", when new", sum.when_new);
  }
  page.write();
}

}  // namespace strata::experiments
