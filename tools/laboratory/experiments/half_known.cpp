// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/half_known.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/grid/blind_beams.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/laboratory/experiments/spliced_drive.hpp"
#include "tools/pipeline/localization_metrics.hpp"
#include "tools/simulate/random_floor.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr double kFarOff_m = 1.0;
constexpr double kHighScore = 0.9;
constexpr int kDays = 4;
constexpr double kCell_m = 0.05;
constexpr int kFar = 2000;         // cells, beyond any of these buildings
constexpr double kSouth_m = 4.5;   // the corridor's wall of random offices
constexpr double kSlack_m = 0.15;  // noise of poses: the near side of the wall stays

constexpr std::array<const char*, 2> kHalfKnownModels{"filtered", "patch"};
/// Each model without and with it, as shards keep it.
using HalfKnownRows = std::array<HalfKnownOutcome, 2 * kHalfKnownModels.size()>;

VerdictWorld without(const std::string& name, const simulate::ScenarioConfig& scenario,
                     std::uint64_t seed, const CellRect& unseen) {
  const simulate::Simulation simulation = simulate::simulate(scenario, seed);
  std::vector<PosedScan> scans = noisy_scans(simulation, kGoodPoses, seed, 1, kDays - 1);
  Grid<std::uint8_t> cells(kCell_m, unseen, 0);
  std::fill(cells.values().begin(), cells.values().end(), std::uint8_t{1});
  for (PosedScan& scan : scans) (void)blind_beams(scan, cells);
  return world_of_scans(name, simulation, scans);
}

HalfKnownRows rows_of(const VerdictWorld& world, std::uint64_t seed) {
  HalfKnownRows rows{};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r] = drive_half_known(world, kHalfKnownModels[r / 2], r % 2 == 1, seed);
  }
  return rows;
}

void add(const HalfKnownRows& more, HalfKnownRows& sums) {
  for (std::size_t r = 0; r < sums.size(); ++r) sums[r] += more[r];
}

void print(const std::string& name, const HalfKnownRows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const HalfKnownOutcome& o = rows[i];
    const double scans = o.mapped_scans + o.beyond_scans;
    std::printf(
        "%s, %s, beyond_map %s: %.3f m, lost %.0f of %.0f; where it is mapped %.3f m, beyond %.3f "
        "m (%.0f%% of the scans); over 1 m off and called good %.2f%%; score >= 0.9: %.0f%%, of "
        "those wrong %.2f%%\n",
        name.c_str(), kHalfKnownModels[i / 2], i % 2 == 0 ? "off" : "on",
        (o.mapped_error_m + o.beyond_error_m) / std::max(1.0, scans), o.lost, o.runs,
        o.mapped_error_m / std::max(1.0, o.mapped_scans),
        o.beyond_error_m / std::max(1.0, o.beyond_scans),
        100.0 * o.beyond_scans / std::max(1.0, scans), 100.0 * o.called_good / std::max(1.0, scans),
        100.0 * o.high_scored / std::max(1.0, scans),
        100.0 * o.high_scored_wrong / std::max(1.0, o.high_scored));
  }
  std::fflush(stdout);
}

}  // namespace

HalfKnownOutcome& HalfKnownOutcome::operator+=(const HalfKnownOutcome& other) {
  for (double HalfKnownOutcome::*sum :
       {&HalfKnownOutcome::runs, &HalfKnownOutcome::lost, &HalfKnownOutcome::mapped_scans,
        &HalfKnownOutcome::mapped_error_m, &HalfKnownOutcome::beyond_scans,
        &HalfKnownOutcome::beyond_error_m, &HalfKnownOutcome::called_good,
        &HalfKnownOutcome::high_scored, &HalfKnownOutcome::high_scored_wrong}) {
    this->*sum += other.*sum;
  }
  return *this;
}

VerdictWorld half_known_office(std::uint64_t office) {
  const auto wall = static_cast<int>((kSouth_m - kSlack_m) / kCell_m);
  return without("office " + std::to_string(office),
                 simulate::random_office(office, {.days = kDays}), office,
                 {{-kFar, -kFar}, {kFar, wall}});
}

VerdictWorld half_known_floor(std::uint64_t floor) {
  const simulate::ScenarioConfig scenario = simulate::random_floor(floor, {.days = kDays});
  double least_m = std::numeric_limits<double>::infinity();
  double greatest_m = -least_m;
  for (std::size_t i = 0; i < scenario.robot.route.size(); i += 2) {
    least_m = std::min(least_m, scenario.robot.route[i]);
    greatest_m = std::max(greatest_m, scenario.robot.route[i]);
  }
  const auto middle = static_cast<int>(0.5 * (least_m + greatest_m) / kCell_m);
  return without("floor " + std::to_string(floor), scenario, floor,
                 {{middle, -kFar}, {kFar, kFar}});
}

HalfKnownOutcome drive_half_known(const VerdictWorld& world, const std::string& model,
                                  bool goes_beyond, std::uint64_t seed) {
  localization::LocalizerConfig config = pipeline::CompareConfig{}.localizer;
  config.beyond_map.is_used = goes_beyond;
  SplicedDrive drive(world, sensor_of(world, model), seed, config);
  drive.localizer().set_free_space(world.maps.filtered);
  HalfKnownOutcome outcome;
  const std::size_t begin = known_from(world, 0);
  if (begin == world.truths.size()) return outcome;
  outcome.runs = 1.0;
  std::vector<pipeline::ScanError> errors;
  drive.start(*world.truths[begin]);
  drive.drive(begin, world.observations.size(), [&](const auto& result, double error_m, Stamp now) {
    const Cell here = cell_at(drive.truth().translation(), world.maps.filtered.resolution_m());
    const bool is_mapped = is_known(world.maps.filtered.get(here));
    (is_mapped ? outcome.mapped_scans : outcome.beyond_scans) += 1.0;
    (is_mapped ? outcome.mapped_error_m : outcome.beyond_error_m) += error_m;
    const bool is_good = result.health.state == localization::HealthState::kGood;
    outcome.called_good += is_good && error_m > kFarOff_m ? 1.0 : 0.0;
    if (result.score >= kHighScore) {
      outcome.high_scored += 1.0;
      outcome.high_scored_wrong += error_m > pipeline::kFailureDistance_m ? 1.0 : 0.0;
    }
    errors.push_back({now, error_m});
    return true;
  });
  outcome.lost = pipeline::evaluate_run(errors).lost ? 1.0 : 0.0;
  return outcome;
}

void report_half_known(const Seeds& seeds, shards::Units& units) {
  const std::array<std::pair<const char*, VerdictWorld (*)(std::uint64_t)>, 2> kinds{
      {{"offices without their south rooms", half_known_office},
       {"floors without a half", half_known_floor}}};
  for (const auto& [name, world] : kinds) {
    HalfKnownRows sums{};
    for (int i = 0; i < seeds.count; ++i) {
      const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
      add(units.of<HalfKnownRows>(std::string(name) + ", seed " + std::to_string(seed),
                                  [&] { return rows_of(world(seed), seed); }),
          sums);
    }
    print(name, sums);
  }
}

void report_half_known_logs(const std::vector<std::string>& logs,
                            const std::vector<std::string>& poses,
                            const std::filesystem::path& runs, const Seeds& seeds) {
  const auto report = [&](const VerdictWorld& world) {
    HalfKnownRows sums{};
    for (int n = 0; n < seeds.count; ++n) {
      add(rows_of(world, seeds.first + static_cast<std::uint64_t>(n)), sums);
    }
    print(world.name, sums);
  };
  for (std::size_t i = 0; i < logs.size(); ++i) report(world_of_log(logs[i], poses[i]));
  if (runs.empty()) return;
  for (const VerdictWorld& world : worlds_of_runs(runs)) report(world);
}

}  // namespace strata::experiments
