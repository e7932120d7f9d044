// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/patch_localization.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "core/localization/localizer.hpp"
#include "tools/laboratory/experiments/patch_models.hpp"
#include "tools/simulate/random_office.hpp"
#include "tools/simulate/truth.hpp"

namespace strata::experiments {
namespace {

using localization::Localizer;
using localization::LocalizerConfig;

constexpr int kRecognitionUpdates = 20;
constexpr double kRecognized = 0.9;

/// Follows one sub-map's belief from each entry on. Entered: within 1 m of its rectangle, the
/// margin that opens an observation sequence (docs/theory/patch_maps.md, "Sequences").
class Recognition {
 public:
  Recognition(const CellRect& rect, double resolution_m, std::size_t truth)
      : near_(rect.inflated(static_cast<int>(1.0 / resolution_m))),
        resolution_m_(resolution_m),
        truth_(truth) {}

  void add(const Pose2& pose, const localization::SubmapBelief& belief, bool weighed,
           DayOutcome& outcome) {
    const bool is_near = near_.contains(cell_at(pose.translation(), resolution_m_));
    if (!is_near) {
      is_inside_ = false;
      return;
    }
    if (!is_inside_) {
      is_inside_ = true;
      is_open_ = true;
      updates_ = 0;
      ++outcome.entries;
    }
    if (!is_open_ || !weighed) return;
    ++updates_;
    if (belief.probability[truth_] > kRecognized) {
      ++outcome.recognized;
      is_open_ = false;
    } else if (updates_ >= kRecognitionUpdates) {
      is_open_ = false;
    }
  }

 private:
  CellRect near_;
  double resolution_m_;
  std::size_t truth_;
  bool is_inside_ = false;
  bool is_open_ = false;
  int updates_ = 0;
};

struct DayTask {
  const simulate::Simulation* simulation = nullptr;
  int day = 1;
  const patch::PatchMap* patches = nullptr;  ///< with truth: recognition is watched
  TrueConfigurations truth;
  const ReflectionGrid* free_space = nullptr;  ///< a global start
  double changed_from_m = 0.0;
  double changed_to_m = 0.0;
};

DayOutcome run_day(const DayTask& task, const Model& model, const LocalizerConfig& config,
                   std::uint64_t seed) {
  const auto& scans = task.simulation->days[static_cast<std::size_t>(task.day - 1)].scans;
  Localizer localizer(config, model, seed, 2);
  if (task.free_space != nullptr) {
    localizer.initialize_global(*task.free_space);
  } else {
    localizer.initialize(
        {scans.front().map_from_robot, Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal()});
  }
  std::vector<std::pair<std::size_t, Recognition>> watched;
  for (std::size_t s = 0; s < task.truth.size() && model->patch_states() != nullptr; ++s) {
    if (!task.truth[s]) continue;
    watched.emplace_back(s, Recognition(task.patches->submaps[s].rect,
                                        task.patches->base.resolution_m(), *task.truth[s]));
  }
  DayOutcome outcome;
  std::size_t changed = 0;
  const std::size_t last = scans.size() - scans.size() / 5;
  bool is_far = false;
  Stamp far_since;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const localization::LocalizationResult result = localizer.update(scans[i].observation);
    const Pose2& truth = scans[i].map_from_robot;
    const double error = weighted_error(localizer.particles(), truth);
    outcome.error_m += error / static_cast<double>(scans.size());
    if (error > 0.5) outcome.failure_rate += 1.0 / static_cast<double>(scans.size());
    if (i >= last) outcome.final_error_m += error / static_cast<double>(scans.size() - last);
    if (truth.x >= task.changed_from_m && truth.x <= task.changed_to_m) {
      outcome.changed_error_m += error;
      ++changed;
    }
    const Stamp now = scans[i].observation.scan.stamp;
    if (error > 1.0 && !is_far) far_since = now;
    is_far = error > 1.0;
    if (is_far && (now - far_since).seconds() >= 5.0) outcome.is_lost = true;
    for (auto& [s, recognition] : watched) {
      recognition.add(truth, result.submaps[s], result.weighed, outcome);
    }
  }
  if (changed > 0) outcome.changed_error_m /= static_cast<double>(changed);
  return outcome;
}

}  // namespace

Outcomes box_in_corridor(const std::string& scenario, std::uint64_t seed, int field_of_view_deg,
                         const std::vector<std::string>& models) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario);
  config.laser.field_of_view_deg = field_of_view_deg;
  config.laser.beams = field_of_view_deg;
  const simulate::Simulation simulation = simulate::simulate(config, seed);
  const int last = static_cast<int>(simulation.days.size());
  const std::vector<PosedScan> scans = noisy_scans(simulation, {}, seed, 1, last - 1);
  const StaticMaps maps = static_maps(scans);
  const auto patches = std::make_shared<const patch::PatchMap>(learn_patches(scans, maps.filtered));
  DayTask task{&simulation, last, patches.get(), {}, nullptr, 11.0, 25.0};
  task.truth = true_configurations(simulation, *patches, simulation, last);
  Outcomes outcomes;
  for (const std::string& name : models) {
    Model model;
    if (name == "own_day") {
      model = grid_model(static_maps(noisy_scans(simulation, {}, seed, last, last)).filtered);
    } else {
      model = model_named(name, maps, patches);
    }
    outcomes[name] = run_day(task, model, {}, seed);
  }
  return outcomes;
}

Outcomes global_start(const std::string& scenario, std::uint64_t seed, bool is_open,
                      const std::vector<std::string>& models) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario);
  const simulate::Simulation learned = simulate::simulate(config, seed);
  const std::vector<PosedScan> both = noisy_scans(learned, {}, seed, 1, 2);
  const StaticMaps maps = static_maps(both);
  const auto patches = std::make_shared<const patch::PatchMap>(learn_patches(both, maps.filtered));
  config.days = 1;
  // From the end where the niche is out of sight: what is seen first is the door.
  config.robot.route = {15.0, 1.0, 10.5, 1.0, 15.0, 1.0, 10.5, 1.0};
  config.doors[0].states.schedule = {{1, 0.0, is_open ? "open" : "closed"}};
  const simulate::Simulation tested = simulate::simulate(config, seed + 1000);
  LocalizerConfig localizer;
  localizer.global_search.is_used = false;  // the paper draws particles anywhere
  localizer.global_start.max_particles = 20000;
  DayTask task{&tested, 1, patches.get(), {}, &maps.filtered, 0.0, 0.0};
  task.truth = true_configurations(learned, *patches, tested, 1);
  Outcomes outcomes;
  for (const std::string& name : models) {
    Model model;
    if (name == "closed" || name == "open") {
      const int day = name == "closed" ? 1 : 2;
      model = grid_model(static_maps(noisy_scans(learned, {}, seed, day, day)).filtered);
    } else {
      model = model_named(name, maps, patches);
    }
    outcomes[name] = run_day(task, model, localizer, seed);
  }
  return outcomes;
}

simulate::Simulation drive_while_door_opens(const std::string& scenario, std::uint64_t seed) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario);
  config.days = 1;
  // As in global_start, there and back in each phase.
  config.robot.route = {15.0, 1.0, 10.5, 1.0, 15.0, 1.0, 10.5, 1.0};
  config.robot.laps = 2;
  config.doors[0].states.schedule = {{1, 0.0, "closed"}};
  const simulate::Simulation closed = simulate::simulate(config, seed);
  const auto& scans = closed.days[0].scans;
  const auto stamp = [](const simulate::SimulatedScan& scan) {
    return scan.observation.scan.stamp;
  };
  const double half_s = 0.5 * (stamp(scans.back()) - stamp(scans.front())).seconds();
  config.doors[0].states.schedule.push_back({1, half_s, "open"});
  return simulate::simulate(config, seed);
}

std::map<std::string, TwoPhases> door_opens(const std::string& scenario, std::uint64_t seed,
                                            const std::vector<std::string>& models) {
  const simulate::Simulation learned = simulate::simulate(simulate::load_scenario(scenario), seed);
  const std::vector<PosedScan> both = noisy_scans(learned, {}, seed, 1, 2);
  const StaticMaps maps = static_maps(both);
  const auto patches = std::make_shared<const patch::PatchMap>(learn_patches(both, maps.filtered));
  const simulate::Simulation tested = drive_while_door_opens(scenario, seed + 1000);
  const auto& scans = tested.days[0].scans;
  const std::size_t half = scans.size() / 2;
  const std::size_t fifth = half / 5;
  LocalizerConfig localizer_config;
  localizer_config.global_search.is_used = false;
  localizer_config.global_start.max_particles = 20000;
  std::map<std::string, TwoPhases> result;
  for (const std::string& name : models) {
    Model model;
    if (name == "closed" || name == "open") {
      const int day = name == "closed" ? 1 : 2;
      model = grid_model(static_maps(noisy_scans(learned, {}, seed, day, day)).filtered);
    } else {
      model = model_named(name, maps, patches);
    }
    Localizer localizer(localizer_config, model, seed, 2);
    localizer.initialize_global(maps.filtered);
    TwoPhases& phases = result[name];
    for (std::size_t i = 0; i < scans.size(); ++i) {
      (void)localizer.update(scans[i].observation);
      const double error = weighted_error(localizer.particles(), scans[i].map_from_robot);
      const double share = error / static_cast<double>(fifth);
      if (i >= half - fifth && i < half) phases.closed_m += share;
      if (i >= scans.size() - fifth) phases.open_m += share;
    }
  }
  return result;
}

Outcomes office_day(std::uint64_t office, std::uint64_t seed,
                    const std::vector<std::string>& models) {
  const simulate::Simulation simulation =
      simulate::simulate(simulate::random_office(office, {4, true, 2}), seed);
  const std::vector<PosedScan> scans = noisy_scans(simulation, kGoodPoses, seed, 1, 3);
  const StaticMaps maps = static_maps(scans);
  const auto patches = std::make_shared<const patch::PatchMap>(learn_patches(scans, maps.filtered));
  DayTask task{&simulation, 4, patches.get(), {}, nullptr, 0.0, 0.0};
  task.truth = true_configurations(simulation, *patches, simulation, 4);
  Outcomes outcomes;
  for (const std::string& name : models) {
    outcomes[name] = run_day(task, model_named(name, maps, patches), {}, seed);
  }
  return outcomes;
}

}  // namespace strata::experiments
