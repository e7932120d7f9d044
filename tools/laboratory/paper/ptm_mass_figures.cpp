// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/topology/mapper_config.hpp"
#include "tools/laboratory/experiments/corridor_building.hpp"
#include "tools/laboratory/experiments/topology_trial.hpp"
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {
namespace {

constexpr int kSeeds = 10;
constexpr double kOdometryError = 0.1;

/// Nine crossings of which some look alike, twelve visits, about 110 m.
experiments::CorridorPlan first_building() {
  experiments::CorridorPlan plan;
  plan.route = {0, 1, 2, 5, 4, 3, 6, 7, 8, 5, 2, 1};
  return plan;
}

/// Fourteen crossings round a block 60 m long with corridors across, twenty visits, about 250 m.
experiments::CorridorPlan second_building() {
  experiments::CorridorPlan plan;
  plan.columns = 7;
  plan.rows = 2;
  plan.spacing_y_m = 20.0;
  plan.route = {0, 1, 2, 3, 4, 5, 6, 13, 12, 11, 10, 9, 8, 7, 0, 1, 2, 3, 10, 9};
  return plan;
}

/// Drawn particles, weighed as printed, landmarks as far apart as the paper's.
topology::TopologyMapperConfig papers_form() {
  topology::TopologyMapperConfig config;
  config.topology.expansion = topology::Expansion::kParticles;
  config.topology.weighting = topology::Weighting::kPaper;
  config.topology.location = {};
  return config;
}

Outcome mass_of_truth(const Setting& setting, const experiments::CorridorPlan& plan,
                      double papers_mass) {
  simulate::ScenarioConfig building = experiments::corridor_building(plan);
  experiments::set_odometry_error(building.robot, kOdometryError);
  experiments::TopologyTrial ours;
  experiments::TopologyTrial papers;
  const int seeds = setting.seeds_or(kSeeds);
  for (int i = 0; i < seeds; ++i) {
    ours += experiments::try_topologies(building, setting.seed(i));
    papers += experiments::try_topologies(building, setting.seed(i), papers_form());
  }
  // Where no partition of what was found is the true one, the truth has no mass.
  const double mass = ours.truth_mass / seeds;
  return judged(
      mass >= papers_mass, "the truth has less mass than in the paper",
      {{"seeds", {}, static_cast<double>(seeds), 0},
       {"visits", papers.visits, ours.visits, 0},
       {"mean mass of the truth", papers.truth_mass / seeds, mass, 3},
       {"seeds in which it is the likeliest", papers.truth_first, ours.truth_first, 0},
       {"seeds in which landmarks make a true partition", papers.partitions, ours.partitions, 0}},
      {});
}

}  // namespace

std::vector<Figure> ptm_mass_figures() {
  const char* const material =
      "simulated corridors whose crossings look alike, 8 m of laser, odometry 10% off, landmarks "
      "found in the scans";
  return {{"ptm-mass-1", "ptm", "Mass of the truth, experiment 1", "the truth has 94%.",
           "over the seeds the true partition has a mean mass of at least 0.94.", material,
           [](const Setting& s) { return mass_of_truth(s, first_building(), 0.94); }, ""},
          {"ptm-10", "ptm", "Mass of the truth, experiment 2", "the truth has 82% or 89%.",
           "over the seeds the true partition has a mean mass of at least 0.82.", material,
           [](const Setting& s) { return mass_of_truth(s, second_building(), 0.82); }, ""}};
}

}  // namespace strata::paper
