// SPDX-License-Identifier: Apache-2.0
/// How often each way of following topologies ends with the truth first, in the buildings of
/// docs/theory/topological_mapping.md, "Test worlds": `topology_figures`. Two threads, a minute.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "core/topology/topology_filter.hpp"
#include "tests/core/topology/junction_world.hpp"

namespace strata::topology {
namespace {

constexpr int kSeeds = 20;
constexpr std::uint64_t kFirstSeed = 100;

struct World {
  std::vector<test_world::Junction> junctions;
  std::vector<int> order;
  double per_metre_m = 0.0;
};

void print_tally(const World& world, TopologyConfig config) {
  config.odometry.per_metre_m = world.per_metre_m;
  int first = 0;
  int above_80_percent = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
    const test_world::Drive drive =
        test_world::drive(world.junctions, world.order, config.odometry, seed);
    TopologyFilter filter(config, seed, 2);
    for (const LandmarkVisit& visit : drive.visits) filter.add(visit);
    const Hypothesis& likeliest = filter.posterior().front();
    if (likeliest.labels != drive.truth) continue;
    ++first;
    above_80_percent += likeliest.probability > 0.8 ? 1 : 0;
  }
  std::printf(" %d (%d above 80%%) of %d |", first, above_80_percent, kSeeds);
  std::fflush(stdout);
}

void print_row(const char* name, const TopologyConfig& config) {
  std::printf("| %s |", name);
  print_tally({test_world::nine_junctions(), test_world::twelve_visits(),
               kLandmarkOdometryNoise.per_metre_m},
              config);
  print_tally({test_world::fourteen_junctions(), test_world::twenty_visits(), 0.08}, config);
  std::printf("\n");
}

}  // namespace
}  // namespace strata::topology

int main() {
  using namespace strata::topology;
  std::printf("| | 12 visits, 120 m | 20 visits, 60 m wide, odometry 8%% off |\n|---|---|---|\n");
  TopologyConfig config;
  print_row("50 best topologies (default)", config);
  config.expansion = Expansion::kParticles;
  print_row("50 particles, proposal (16), weight with its normalizer", config);
  config.weighting = Weighting::kPaper;
  print_row("... the paper's own weight", config);
  config.weighting = Weighting::kCorrected;
  config.proposal = Proposal::kPrior;
  print_row("... the plain proposal (4)", config);
  config.proposal = Proposal::kOdometry;
  config.particles = 1000;
  print_row("1,000 particles, proposal (16), weight with its normalizer", config);
  config.match.look_alike_gain = 1000.0;
  print_row("... matches say as much as they like", config);
  config.particles = 50;
  print_row("50 particles, matches say as much as they like", config);
  config.expansion = Expansion::kBest;
  print_row("50 best, matches say as much as they like", config);
  return 0;
}
