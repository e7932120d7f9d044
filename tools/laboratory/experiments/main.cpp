// SPDX-License-Identifier: Apache-2.0
/// `strata-experiments NAME`: runs one experiment over several seeds and prints its figures.
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/error.hpp"
#include "tools/laboratory/experiments/among_people.hpp"
#include "tools/laboratory/experiments/few_beams.hpp"
#include "tools/laboratory/experiments/patch_learning.hpp"
#include "tools/laboratory/experiments/patch_localization.hpp"
#include "tools/laboratory/experiments/real_scans_report.hpp"
#include "tools/laboratory/experiments/score_report.hpp"
#include "tools/laboratory/experiments/single_scan.hpp"
#include "tools/laboratory/experiments/standing_robot.hpp"
#include "tools/laboratory/experiments/verdicts.hpp"
#include "tools/laboratory/experiments/wean.hpp"
#include "tools/laboratory/experiments/year.hpp"
#include "tools/laboratory/experiments/year_report.hpp"

namespace {

using namespace strata::experiments;

struct Options {
  std::string scenarios = STRATA_SCENARIO_DIR;
  std::uint64_t first = 1;
  int seeds = 20;
  bool has_poor_poses = false;
  int days = 365;
  int particles = 150;
  std::string out = "experiment";
  std::string memory_model = "timescale";
  bool no_patches = false;
  bool has_whole_scenes = false;
  std::vector<std::string> overrides;
  std::vector<std::string> logs;
  std::vector<std::string> poses;
  std::vector<double> before_s{0.0, 1e9};
  std::vector<double> after_s{0.0, 1e9};
  std::vector<double> place_m;
  double radius_m = 1.0;
  std::vector<double> object_m;
  std::string runs;
  double margin_nats = 40.0;
  int step = 1;
  std::vector<std::string> scenario_names;

  [[nodiscard]] std::string file(const char* name) const { return scenarios + "/" + name; }
  [[nodiscard]] PoseNoise noise() const { return has_poor_poses ? kPoorPoses : kGoodPoses; }
};

void print(const std::string& name, const Judgement& j, int whole, int seeds) {
  std::cout << name << ": " << j.found_objects << " of " << j.changed_objects
            << " changed objects found, " << j.submaps << " sub-maps, " << j.false_submaps
            << " false; configurations extra " << j.extra_configurations << ", missing "
            << j.missing_configurations << "; sequences in the right one " << j.right_sequences
            << " of " << j.sequences << "; seeds without any mistake " << whole << " of " << seeds
            << "\n";
}

void learn(const std::string& name, const Options& options,
           const std::function<Judgement(std::uint64_t)>& one) {
  Judgement sum;
  int whole = 0;
  for (int i = 0; i < options.seeds; ++i) {
    const Judgement j = one(options.first + static_cast<std::uint64_t>(i));
    const bool is_whole = j.found_objects == j.changed_objects && j.false_submaps == 0 &&
                          j.extra_configurations == 0 && j.missing_configurations == 0;
    whole += is_whole ? 1 : 0;
    sum += j;
  }
  print(name, sum, whole, options.seeds);
}

void localize(const std::string& name, const Options& options,
              const std::function<Outcomes(std::uint64_t)>& one) {
  struct Sum {
    DayOutcome mean;
    int lost = 0;
    int failed = 0;
  };
  std::map<std::string, Sum> sums;
  for (int i = 0; i < options.seeds; ++i) {
    for (const auto& [model, outcome] : one(options.first + static_cast<std::uint64_t>(i))) {
      Sum& sum = sums[model];
      sum.mean.error_m += outcome.error_m / options.seeds;
      sum.mean.changed_error_m += outcome.changed_error_m / options.seeds;
      sum.mean.final_error_m += outcome.final_error_m / options.seeds;
      sum.mean.failure_rate += outcome.failure_rate / options.seeds;
      sum.mean.entries += outcome.entries;
      sum.mean.recognized += outcome.recognized;
      sum.lost += outcome.is_lost ? 1 : 0;
      sum.failed += outcome.final_error_m > 1.0 ? 1 : 0;
    }
  }
  for (const auto& [model, sum] : sums) {
    std::cout << name << " " << model << ": error " << sum.mean.error_m << " m, where it changes "
              << sum.mean.changed_error_m << " m, at the end " << sum.mean.final_error_m
              << " m; failure rate " << sum.mean.failure_rate << ", lost " << sum.lost
              << ", ended wrong " << sum.failed << " of " << options.seeds
              << "; true configuration known within 20 updates of " << sum.mean.recognized << " of "
              << sum.mean.entries << " entries\n";
  }
}

/// Writes a row a day to year.csv, plots, and prints the sums.
void live_a_year(const Options& options) {
  YearOptions year;
  year.scenario = options.file("year.yaml");
  year.seed = options.first;
  year.days = options.days;
  year.particles = options.particles;
  year.memory_model = options.memory_model;
  year.with_patches = !options.no_patches;
  if (options.has_whole_scenes) year.decoding = strata::memory::scene_decoding();
  year.overrides = options.overrides;
  year.out = options.out;
  std::filesystem::create_directories(year.out);
  YearReport report(year.out);
  run_year(year, [&](const YearDay& day) { report.add(day); });
  report.finish();
}

/// The logs with their poses, the i-th for the i-th.
std::vector<Occasion> occasions(const Options& options) {
  if (options.logs.empty() || options.logs.size() != options.poses.size()) {
    throw strata::InputError("--log and --poses", "do not belong together",
                             "give a file of poses for each log");
  }
  std::vector<Occasion> result;
  for (std::size_t i = 0; i < options.logs.size(); ++i) {
    result.push_back({options.logs[i], options.poses[i]});
  }
  return result;
}

/// Two parts of one log, or parts of two.
void look_at_place(const Options& options) {
  const std::vector<Occasion> logs = occasions(options);
  PlaceOptions place;
  place.before = logs.front();
  place.after = logs.back();
  place.before.from_s = options.before_s[0];
  place.before.to_s = options.before_s[1];
  place.after.from_s = options.after_s[0];
  place.after.to_s = options.after_s[1];
  if (!options.place_m.empty()) place.place_m.emplace(options.place_m[0], options.place_m[1]);
  place.radius_m = options.radius_m;
  if (!options.object_m.empty()) place.object = {options.object_m[0], options.object_m[1]};
  place.seeds = options.seeds;
  place.first_seed = options.first;
  place.out = options.out;
  report_place(place);
}

void run(const std::string& name, const Options& options) {
  if (name == "year") return live_a_year(options);
  if (name == "place") return look_at_place(options);
  if (name == "people") return report_people(options.scenarios, options.first, options.seeds);
  if (name == "filter") {
    return report_filter_against_none(options.scenarios, options.first, options.seeds);
  }
  if (name == "few_beams") return report_few_beams(options.scenarios, options.first, options.seeds);
  if (name == "wean" && options.runs.empty()) {
    throw strata::InputError("--runs", "is missing",
                             "name the folder with run1.clf.gz to run3.clf.gz");
  }
  if (name == "wean") return report_wean(options.runs, options.first, options.seeds);
  if (name == "single_scan") {
    (void)occasions(options);  // as many poses as logs
    return report_single_scans(options.logs, options.poses, options.margin_nats, options.step);
  }
  if (name == "decoders") return report_decoders(occasions(options));
  if (name == "verdicts") {
    if (!options.logs.empty()) (void)occasions(options);  // as many poses as logs
    return report_verdicts(options.runs, options.logs, options.poses, options.first);
  }
  if (name == "score") {
    if (!options.logs.empty()) (void)occasions(options);  // as many poses as logs
    return report_score({options.logs, options.poses, options.runs, options.scenarios,
                         options.scenario_names, options.first, options.seeds, options.out});
  }
  if (name == "three_doors") {
    learn(name, options, [&](std::uint64_t seed) {
      return three_doors(options.file("three_doors.yaml"), seed, options.noise());
    });
  } else if (name == "local_maps") {
    learn(name, options, [&](std::uint64_t seed) {
      return local_maps(options.file("four_states.yaml"), seed, options.noise());
    });
  } else if (name == "few_visits" || name == "static_offices") {
    std::vector<int> all_days{2, 3, 4, 5};
    // With more the test for many visits decides.
    if (name == "static_offices") all_days.insert(all_days.end(), {8, 12, 16});
    for (const int days : all_days) {
      learn(name + ", " + std::to_string(days) + " days", options, [&](std::uint64_t seed) {
        return office_visits(seed, days, name == "few_visits", options.noise());
      });
    }
  } else if (name == "standing_robot" || name == "standing_robot_online") {
    const auto one = name == "standing_robot" ? standing_robot : standing_robot_online;
    for (const int toggles : {4, 0}) {
      learn(name + ", door moved " + std::to_string(toggles) + " times", options,
            [&](std::uint64_t seed) { return one(seed, toggles, options.noise()); });
    }
  } else if (name == "box_in_corridor") {
    for (const int field_of_view_deg : {360, 180}) {
      localize(name + ", " + std::to_string(field_of_view_deg) + " degrees,", options,
               [&](std::uint64_t seed) {
                 return box_in_corridor(
                     options.file("corridor_box.yaml"), seed, field_of_view_deg,
                     {"occupancy", "filtered", "patch_paper", "patch_shared", "patch", "own_day"});
               });
    }
  } else if (name == "global_start") {
    for (const bool is_open : {false, true}) {
      localize(name + (is_open ? ", door open," : ", door closed,"), options,
               [&](std::uint64_t seed) {
                 return global_start(options.file("side_door.yaml"), seed, is_open,
                                     {"closed", "open", "patch", "patch_paper"});
               });
    }
  } else if (name == "offices") {
    for (std::uint64_t office = 1; office <= 10; ++office) {
      localize("office " + std::to_string(office), options, [&](std::uint64_t seed) {
        return office_day(office, seed, {"occupancy", "filtered", "patch"});
      });
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::string name;
  CLI::App app{"the experiments of docs/results.md"};
  app.add_option("NAME", name, "which experiment")
      ->required()
      ->check(
          CLI::IsMember({"three_doors", "local_maps", "few_visits", "static_offices",
                         "box_in_corridor", "global_start", "offices", "year", "place", "decoders",
                         "wean", "verdicts", "score", "people", "filter", "few_beams",
                         "single_scan", "standing_robot", "standing_robot_online"}));
  app.add_option("--seeds", options.seeds, "how many")->check(CLI::Range(0, 1'000'000));
  app.add_option("--first-seed", options.first, "the first of them");
  app.add_flag("--poor-poses", options.has_poor_poses,
               "errors of 5 cm and 1 degree, not 2 cm and 0.3");
  app.add_option("--days", options.days, "of the year")->check(CLI::Range(2, 3650));
  app.add_option("--particles", options.particles, "of the year's robots")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--memory-model", options.memory_model,
                 "what the year's memory localizes by: timescale (all levels), timescale_LEVEL");
  app.add_flag("--whole-scenes", options.has_whole_scenes, "decode the year's memory by scenes");
  app.add_flag("--no-patches", options.no_patches, "the year without the robot with a patch map");
  app.add_option("--set", options.overrides, "key.path=value of the year's scenario");
  app.add_option(
      "--log", options.logs,
      "real logs of `place` (one or two), `decoders`, `verdicts`, `score` and `single_scan`");
  app.add_option("--runs", options.runs,
                 "folder of the three runs of `wean`, `verdicts` and `score`");
  app.add_option("--poses", options.poses, "a file of poses for each");
  app.add_option("--before", options.before_s, "seconds of the first log: the first state")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--after", options.after_s, "seconds of the last log: the second state")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--place", options.place_m, "x,y of the node; without: where most has changed")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--radius", options.radius_m, "m; scans taken within it of the node count")
      ->check(CLI::Range(0.01, 1000.0));
  app.add_option("--object", options.object_m,
                 "m ahead,m wide: a board put into the scans of the second state")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--margin", options.margin_nats,
                 "nats by which `single_scan` accepts a place before all others");
  app.add_option("--step", options.step, "of the scans of `single_scan` every so many-th only")
      ->check(CLI::PositiveNumber);
  app.add_option("--out", options.out, "where files of the year or the place go");
  app.add_option("--scenario", options.scenario_names,
                 "a file there, of several days, for `score` besides the offices");
  app.add_option("--scenarios", options.scenarios, "folder of the scenario files");
  CLI11_PARSE(app, argc, argv);
  try {
    run(name, options);
  } catch (const std::exception& error) {
    std::cerr << "strata-experiments: error: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
