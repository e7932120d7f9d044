// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/refined_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <optional>
#include <utility>
#include <vector>

#include "components/maps/map_model.hpp"
#include "components/maps/refiner.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/localizer.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/pipeline/truth_frame.hpp"
#include "tools/simulate/random_office.hpp"
#include "tools/simulate/simulation.hpp"
#include "tools/statistics/error_summary.hpp"

namespace strata::experiments {
namespace {

constexpr std::array<const char*, 2> kModels{"filtered", "patch"};
using ByModel = std::map<std::string, RefinedOutcome>;
/// As shards keep it.
using Rows = std::array<RefinedOutcome, kModels.size()>;

struct LearnedWorld {
  maps::Maps maps;
  Pose2 map_from_truth;
};

LearnedWorld learn_before(const simulate::Simulation& simulation, std::size_t last) {
  pipeline::Runs runs;
  for (std::size_t day = 0; day < last; ++day) {
    for (const simulate::SimulatedScan& scan : simulation.days[day].scans) {
      runs.observations.push_back(scan.observation);
      runs.truths.emplace_back(scan.map_from_robot);
    }
  }
  pipeline::LearnResult learned =
      pipeline::learn(runs.observations, {}, {}, {.timescale = false}, 1, 2, nullptr);
  std::vector<pipeline::LearnedPose> poses;
  for (const PosedScan& scan : learned.slam.scans) {
    poses.push_back({scan.run, scan.scan.stamp, scan.map_from_robot});
  }
  LearnedWorld world;
  world.map_from_truth = pipeline::map_from_truth(runs, poses).value_or(Pose2{});
  world.maps.occupancy = std::move(learned.slam.occupancy);
  world.maps.filtered = std::move(learned.slam.filtered);
  world.maps.surfaces = std::move(learned.slam.surfaces);
  world.maps.patches = std::move(learned.patches);
  return world;
}

RefinedOutcome localize_day(const simulate::SimulatedDay& day, const LearnedWorld& world,
                            const std::string& name, std::uint64_t seed) {
  const maps::MapModel model = maps::make_map_model(world.maps, name, {});
  const auto refiner = maps::make_refiner(world.maps, *model.descriptor, {});
  localization::Localizer localizer({}, model.sensor, seed, 2);
  localizer.initialize(
      {world.map_from_truth * day.scans.front().map_from_robot, pose_covariance(0.2, 0.1)});
  RefinedOutcome outcome;
  std::vector<double> errors_m;
  for (const simulate::SimulatedScan& scan : day.scans) {
    const localization::LocalizationResult& result = localizer.update(scan.observation);
    const Pose2 truth = world.map_from_truth * scan.map_from_robot;
    outcome.scans += 1.0;
    const auto refined = refiner->refine(scan.observation.scan, result);
    if (!refined) continue;
    errors_m.push_back(translation_distance(refined->mean, truth));
    outcome.particles_m += weighted_error(localizer.particles(), truth);
    outcome.filtered_m += translation_distance(result.pose.mean, truth);
    outcome.refined_rad += std::abs(angle_difference(refined->mean.theta, truth.theta));
    outcome.mahalanobis_squared += mahalanobis_squared(*refined, truth);
    outcome.filtered_mahalanobis_squared += mahalanobis_squared(result.pose, truth);
  }
  outcome.refined = static_cast<double>(errors_m.size());
  if (errors_m.empty()) return outcome;
  for (double* sum : {&outcome.particles_m, &outcome.filtered_m, &outcome.refined_rad,
                      &outcome.mahalanobis_squared, &outcome.filtered_mahalanobis_squared}) {
    *sum /= outcome.refined;
  }
  const statistics::ErrorSummary summary = statistics::summarize(errors_m);
  outcome.refined_m = summary.mean;
  outcome.refined_p95_m = summary.p95;
  return outcome;
}

void add(RefinedOutcome& sum, const RefinedOutcome& one, double weight) {
  sum.scans += one.scans;
  sum.refined += one.refined;
  sum.particles_m += weight * one.particles_m;
  sum.filtered_m += weight * one.filtered_m;
  sum.refined_m += weight * one.refined_m;
  sum.refined_p95_m += weight * one.refined_p95_m;
  sum.refined_rad += weight * one.refined_rad;
  sum.mahalanobis_squared += weight * one.mahalanobis_squared;
  sum.filtered_mahalanobis_squared += weight * one.filtered_mahalanobis_squared;
}

void report_world(const std::string& name, const Seeds& seeds, shards::Units& units,
                  const std::function<simulate::ScenarioConfig(std::uint64_t)>& world) {
  Rows mean{};
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const auto rows = units.of<Rows>(name + ", seed " + std::to_string(seed), [&] {
      const ByModel one = refine_last_day(world(seed), seed);
      Rows result{};
      for (std::size_t m = 0; m < kModels.size(); ++m) result[m] = one.at(kModels[m]);
      return result;
    });
    for (std::size_t m = 0; m < kModels.size(); ++m) add(mean[m], rows[m], 1.0 / seeds.count);
  }
  std::cout << std::fixed << std::setprecision(4);
  for (std::size_t m = 0; m < kModels.size(); ++m) {
    const RefinedOutcome& row = mean[m];
    std::cout << name << ", " << kModels[m] << ": refined " << row.refined_m << " m, 95% "
              << row.refined_p95_m << " m, " << row.refined_rad << " rad; the filter's mean "
              << row.filtered_m << " m, its particles " << row.particles_m << " m; in "
              << 100.0 * row.refined / std::max(1.0, row.scans)
              << "% of the scans; squared Mahalanobis distance " << row.mahalanobis_squared
              << ", of the filter " << row.filtered_mahalanobis_squared << "\n";
  }
}

}  // namespace

std::map<std::string, RefinedOutcome> refine_last_day(const simulate::ScenarioConfig& world,
                                                      std::uint64_t seed) {
  const simulate::Simulation simulation = simulate::simulate(world, seed);
  const std::size_t last = simulation.days.size() - 1;
  const LearnedWorld learned = learn_before(simulation, last);
  ByModel outcomes;
  for (const char* name : kModels) {
    outcomes[name] = localize_day(simulation.days[last], learned, name, seed);
  }
  return outcomes;
}

void report_refined_poses(const std::string& scenarios, const Seeds& seeds, shards::Units& units) {
  const simulate::ScenarioConfig office = simulate::load_scenario(scenarios + "/office.yaml");
  report_world("office", seeds, units, [&](std::uint64_t) { return office; });
  report_world("office, 1440 beams of 1 cm noise", seeds, units, [&](std::uint64_t) {
    simulate::ScenarioConfig fine = office;
    fine.laser.beams = 1440;
    fine.laser.field_of_view_deg = 360.0;
    fine.laser.noise_m = 0.01;
    return fine;
  });
  const simulate::ScenarioConfig corridor =
      simulate::load_scenario(scenarios + "/corridor_box.yaml");
  report_world("plain corridor", seeds, units, [&](std::uint64_t) { return corridor; });
  report_world("random offices", seeds, units,
               [](std::uint64_t seed) { return simulate::random_office(seed, {.days = 3}); });
}

}  // namespace strata::experiments
