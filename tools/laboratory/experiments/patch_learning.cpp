// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/patch_learning.hpp"

#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

Judgement learn_and_judge(const simulate::ScenarioConfig& scenario, std::uint64_t seed,
                          const PoseNoise& noise) {
  const simulate::Simulation simulation = simulate::simulate(scenario, seed);
  const std::vector<PosedScan> scans =
      noisy_scans(simulation, noise, seed, 1, static_cast<int>(simulation.days.size()));
  return judge(simulation, learn_patches(scans, static_maps(scans).filtered));
}

}  // namespace

Judgement three_doors(const std::string& scenario, std::uint64_t seed, const PoseNoise& noise) {
  return learn_and_judge(simulate::load_scenario(scenario), seed, noise);
}

Judgement local_maps(const std::string& scenario, std::uint64_t seed, const PoseNoise& noise) {
  return learn_and_judge(simulate::load_scenario(scenario), seed, noise);
}

Judgement office_visits(std::uint64_t seed, int days, bool has_change, const PoseNoise& noise) {
  return learn_and_judge(simulate::random_office(seed, {days, has_change, 2}), seed, noise);
}

}  // namespace strata::experiments
