// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>

#include "tools/laboratory/experiments/wean.hpp"
#include "tools/laboratory/experiments/wean_doors.hpp"

namespace strata::experiments {
namespace {

constexpr int kRuns = 3;
constexpr int kThreads = 2;

/// A run's number as the files have it.
int number(int run) { return run + 1; }

void print_places(const std::vector<std::size_t>& doors) {
  for (const std::size_t d : doors) {
    const Eigen::Vector2d& at = wean_doors()[d].middle_m;
    std::printf(" (%.1f, %.1f)", at.x(), at.y());
  }
  std::printf("%s\n", doors.empty() ? " none" : "");
}

/// What the runs saw at each door, two by two.
void print_cells_apart(const WeanRuns& wean) {
  const patch::PatchLearnerConfig config;
  patch::VisitTable visits = patch::find_visits(wean.scans, 0.05, config.visits, config.counting);
  visits.filter(config.contradiction.prior);
  for (const WeanDoor& door : wean_doors()) {
    const auto apart = [&](int a, int b) { return cells_apart(visits, wean.scans, door, a, b); };
    std::printf(
        "door (%.1f, %.1f): cells that one run hit and another saw through: runs 1 and 2 %zu, 1 "
        "and 3 %zu, 2 and 3 %zu\n",
        door.middle_m.x(), door.middle_m.y(), apart(0, 1), apart(0, 2), apart(1, 2));
  }
}

void print_submaps(const patch::PatchMap& map, const WeanDoors& doors) {
  const double m = map.base.resolution_m();
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const patch::Submap& submap = map.submaps[s];
    std::printf("  sub-map x %.2f to %.2f, y %.2f to %.2f: %zu configurations; doors:",
                submap.rect.min.x * m, submap.rect.max.x * m, submap.rect.min.y * m,
                submap.rect.max.y * m, submap.configurations.size());
    print_places(doors.of_submap[s]);
  }
}

void print_error(const char* name, const std::vector<WeanOutcome>& outcomes,
                 WeanError WeanOutcome::*which) {
  double min_m = 1e9;
  double greatest_m = 0.0;
  WeanError mean;
  for (const WeanOutcome& outcome : outcomes) {
    const WeanError& error = outcome.*which;
    mean.mean_m += error.mean_m / static_cast<double>(outcomes.size());
    mean.near_doors_m += error.near_doors_m / static_cast<double>(outcomes.size());
    min_m = std::min(min_m, error.mean_m);
    greatest_m = std::max(greatest_m, error.mean_m);
  }
  std::printf(" against %s %.3f m (seeds %.3f to %.3f), near doors %.3f m;", name, mean.mean_m,
              min_m, greatest_m, mean.near_doors_m);
}

void print_outcomes(const std::string& name, const std::vector<WeanOutcome>& outcomes) {
  double failure_rate = 0.0;
  int lost = 0;
  std::size_t verdicts = 0;
  std::size_t beyond = 0;
  for (const WeanOutcome& outcome : outcomes) {
    failure_rate += outcome.failure_rate / static_cast<double>(outcomes.size());
    lost += outcome.is_lost ? 1 : 0;
    verdicts += outcome.lost_scans;
    beyond += outcome.lost_beyond_scans;
  }
  std::printf("  %s:", name.c_str());
  print_error("the reference", outcomes, &WeanOutcome::reference);
  print_error("common poses", outcomes, &WeanOutcome::common);
  std::printf(
      " failure rate %.3f, lost %d of %zu; scans with the verdict lost: %zu where the map's runs "
      "went, %zu beyond\n",
      failure_rate, lost, outcomes.size(), verdicts, beyond);
}

}  // namespace

void report_wean(const std::filesystem::path& folder, std::uint64_t first_seed, int seeds) {
  const WeanRuns wean = read_wean_runs(folder, kThreads);
  print_cells_apart(wean);
  for (int held_out = 0; held_out < kRuns; ++held_out) {
    const int a = held_out == 0 ? 1 : 0;
    const int b = held_out == 2 ? 1 : 2;
    const auto localize = [&](const std::string& name, const WeanMaps& learned,
                              const std::vector<int>& of, const char* model) {
      std::vector<WeanOutcome> outcomes;
      for (int i = 0; i < seeds; ++i) {
        outcomes.push_back(localize_wean_run(wean, held_out, learned, of, model,
                                             first_seed + static_cast<std::uint64_t>(i), kThreads));
      }
      print_outcomes(name, outcomes);
    };
    const WeanMaps both = learn_wean_maps(wean, {a, b}, true, kThreads);
    const WeanDoors doors = judge_wean_doors(*both.maps.patches, a, b);
    std::printf("run %d held out: runs %d and %d give %zu sub-maps, %zu at no door\n",
                number(held_out), number(a), number(b), both.maps.patches->submaps.size(),
                doors.elsewhere);
    std::printf("  doors changed by the table:");
    print_places(doors.changed);
    std::printf("  doors in both states in a sub-map:");
    print_places(doors.right);
    print_submaps(*both.maps.patches, doors);
    localize("patch, both runs", both, {a, b}, "patch");
    for (const int run : {a, b}) {
      const std::string name = "filtered, run " + std::to_string(number(run)) + " alone, ";
      localize(name + "refined", learn_wean_maps(wean, {run}, true, kThreads), {run}, "filtered");
      localize(name + "at the reference poses", learn_wean_maps(wean, {run}, false, kThreads),
               {run}, "filtered");
    }
    std::fflush(stdout);
  }
}

}  // namespace strata::experiments
