// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "tools/laboratory/experiments/patch_learning.hpp"
#include "tools/laboratory/experiments/patch_localization.hpp"
#include "tools/laboratory/paper/figures.hpp"
#include "tools/report/map_picture.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::paper {
namespace {

using namespace experiments;

std::string file(const Setting& setting, const char* name) {
  return (setting.scenarios / name).string();
}

double real(int value) { return static_cast<double>(value); }

/// What was learned over the seeds, and the sub-maps of the first one.
Outcome learned(const Setting& setting, const std::string& id, const char* scenario, int own,
                Judgement (*one)(const std::string&, std::uint64_t, const PoseNoise&)) {
  const int seeds = setting.seeds_or(own);
  const std::string path = file(setting, scenario);
  Judgement sum;
  for (int i = 0; i < seeds; ++i) {
    sum += one(path, setting.first_seed + static_cast<std::uint64_t>(i), kGoodPoses);
  }
  const auto simulation = simulate::simulate(simulate::load_scenario(path), setting.first_seed);
  const auto scans = noisy_scans(simulation, kGoodPoses, setting.first_seed, 1,
                                 static_cast<int>(simulation.days.size()));
  std::vector<Picture> pictures;
  for (const patch::Submap& submap : learn_patches(scans, static_maps(scans).filtered).submaps) {
    const std::string name = id + "_submap_" + std::to_string(submap.id);
    pictures.push_back({name, "configurations of sub-map " + std::to_string(submap.id),
                        report::encode_png(report::draw_submap(submap, 4))});
  }
  return judged(sum.found_objects == sum.changed_objects && sum.false_submaps == 0 &&
                    sum.extra_configurations == 0 && sum.missing_configurations == 0,
                "an object or a configuration is missing, or there is one too many",
                {{"seeds", {}, real(seeds), 0},
                 {"changed objects", {}, real(sum.changed_objects), 0},
                 {"found", {}, real(sum.found_objects), 0},
                 {"false sub-maps", {}, real(sum.false_submaps), 0},
                 {"configurations extra", {}, real(sum.extra_configurations), 0},
                 {"configurations missing", {}, real(sum.missing_configurations), 0}},
                std::move(pictures));
}

struct Mean {
  double changed_m = 0.0;
  double end_m = 0.0;
  int failed = 0;
  int entries = 0;
  int recognized = 0;
};

template <typename One>
std::map<std::string, Mean> means(const Setting& setting, int seeds, One&& one) {
  std::map<std::string, Mean> result;
  for (int i = 0; i < seeds; ++i) {
    for (const auto& [name, day] : one(setting.first_seed + static_cast<std::uint64_t>(i))) {
      Mean& mean = result[name];
      mean.changed_m += day.changed_error_m / seeds;
      mean.end_m += day.final_error_m / seeds;
      mean.failed += day.final_error_m > 1.0 ? 1 : 0;
      mean.entries += day.entries;
      mean.recognized += day.recognized;
    }
  }
  return result;
}

std::map<std::string, Mean> box(const Setting& setting, int seeds,
                                const std::vector<std::string>& models) {
  return means(setting, seeds, [&](std::uint64_t seed) {
    return box_in_corridor(file(setting, "corridor_box.yaml"), seed, 360, models);
  });
}

Outcome box_error(const Setting& setting) {
  const int seeds = setting.seeds_or(5);
  auto mean = box(setting, seeds, {"occupancy", "filtered", "patch_paper", "patch"});
  const double ours = mean["patch"].changed_m;
  return judged(ours < mean["occupancy"].changed_m && ours < mean["filtered"].changed_m,
                "a map of one state is as good where the box stands",
                {{"seeds", {}, real(seeds), 0},
                 {"error where it changes [m]", mean["patch_paper"].changed_m, ours, 3},
                 {"the same, occupancy map [m]", {}, mean["occupancy"].changed_m, 3},
                 {"the same, filtered map [m]", {}, mean["filtered"].changed_m, 3}},
                {});
}

Outcome recognized(const Setting& setting) {
  const int seeds = setting.seeds_or(5);
  auto mean = box(setting, seeds, {"patch_paper", "patch"});
  const Mean& ours = mean["patch"];
  return judged(
      ours.entries > 0 && 10 * ours.recognized >= 9 * ours.entries,
      "the true configuration is known in fewer than nine of ten entries",
      {{"seeds", {}, real(seeds), 0},
       {"entries", real(mean["patch_paper"].entries), real(ours.entries), 0},
       {"known within 20 updates", real(mean["patch_paper"].recognized), real(ours.recognized), 0}},
      {});
}

Outcome started(const Setting& setting, bool is_open) {
  const int seeds = setting.seeds_or(5);
  auto mean = means(setting, seeds, [&](std::uint64_t seed) {
    return global_start(file(setting, "side_door.yaml"), seed, is_open,
                        {"closed", "open", "patch", "patch_paper"});
  });
  const Mean& wrong = mean[is_open ? "closed" : "open"];
  return judged(5 * mean["patch"].failed <= seeds && 2 * wrong.failed > seeds,
                "patches fail in more than a fifth, or the map of the other state in fewer than "
                "half of the seeds",
                {{"seeds", {}, real(seeds), 0},
                 {"failed starts", real(mean["patch_paper"].failed), real(mean["patch"].failed), 0},
                 {"error at the end [m]", mean["patch_paper"].end_m, mean["patch"].end_m, 2},
                 {"failed, map with the door closed", {}, real(mean["closed"].failed), 0},
                 {"failed, map with the door open", {}, real(mean["open"].failed), 0}},
                {});
}

}  // namespace

std::vector<Figure> patch_figures() {
  const auto doors = [](const Setting& s) {
    return learned(s, "patch-1.11", "three_doors.yaml", 10, three_doors);
  };
  const auto states = [](const Setting& s) {
    return learned(s, "patch-1.18", "four_states.yaml", 20, local_maps);
  };
  const char* const exact =
      "every changed object found, no false sub-map, no configuration extra "
      "or missing.";
  return {
      {"patch-1.11", "patch", "Three doors of an office", "three sub-maps with all configurations.",
       exact, "the simulated three_doors.yaml, poses 2 cm off", doors, ""},
      {"patch-1.12", "patch", "Average of the configurations of a box",
       "the tiles are averages over all patches.", "a picture of means over the members.",
       "nothing yet", nullptr, "only the configurations themselves are drawn"},
      {"patch-1.13", "patch", "Localization error near the box",
       "patches are better than either grid map.",
       "the error where it changes is below those of the occupancy and the filtered map.",
       "the simulated corridor_box.yaml", box_error, ""},
      {"patch-1.14", "patch", "The way with two time labels",
       "the robot enters the sub-map at time 15.", "a picture of the way.", "nothing yet", nullptr,
       "not drawn; its numbers are those of patch-1.15"},
      {"patch-1.15", "patch", "Probability of the true configuration",
       "it comes close to one soon.", "above 0.9 within 20 updates in at least 90% of the entries.",
       "the simulated corridor_box.yaml", recognized, ""},
      {"patch-1.16", "patch", "Global start, door closed (also 1.17, left)",
       "patches and the map with the door closed find the pose; the other diverges.",
       "patches fail in at most a fifth of the seeds, the map with the door open in more than "
       "half.",
       "the simulated side_door.yaml", [](const Setting& s) { return started(s, false); }, ""},
      {"patch-1.17", "patch", "Global start, door open (also 1.16, right)",
       "patches are right still; the map with the door closed is not.",
       "patches fail in at most a fifth of the seeds, the map with the door closed in more than "
       "half.",
       "the simulated side_door.yaml, a start of its own and not the paper's one run",
       [](const Setting& s) { return started(s, true); }, ""},
      {"patch-1.18", "patch", "17 local maps become four clusters",
       "four clusters; a fifth is redundant.", exact,
       "the simulated four_states.yaml, poses 2 cm off", states, ""}};
}

}  // namespace strata::paper
