// SPDX-License-Identifier: Apache-2.0
/// `strata-experiments NAME`: runs one experiment over several seeds and prints its figures.
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <streambuf>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/error.hpp"
#include "tools/laboratory/experiments/door_times.hpp"
#include "tools/laboratory/experiments/experiment_names.hpp"
#include "tools/laboratory/experiments/half_known.hpp"
#include "tools/laboratory/experiments/kidnapped.hpp"
#include "tools/laboratory/experiments/real_scans_report.hpp"
#include "tools/laboratory/experiments/score_report.hpp"
#include "tools/laboratory/experiments/seed_experiments.hpp"
#include "tools/laboratory/experiments/single_scan.hpp"
#include "tools/laboratory/experiments/starts.hpp"
#include "tools/laboratory/experiments/verdicts.hpp"
#include "tools/laboratory/experiments/wean.hpp"
#include "tools/laboratory/experiments/year.hpp"
#include "tools/laboratory/experiments/year_report.hpp"
#include "tools/laboratory/paper/paper_command.hpp"
#include "tools/shards/fingerprint.hpp"
#include "tools/shards/units.hpp"

namespace {

using namespace strata::experiments;
namespace shards = strata::shards;

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
  std::string shard;
  std::vector<std::string> merge;

  [[nodiscard]] std::string file(const char* name) const { return scenarios + "/" + name; }
  [[nodiscard]] SeedOptions of_seeds() const {
    return {scenarios, {first, seeds}, has_poor_poses ? kPoorPoses : kGoodPoses, out};
  }
};

/// std::cout says nothing while there is one.
class QuietOutput {
 public:
  QuietOutput() : before_(std::cout.rdbuf(nullptr)) {}
  ~QuietOutput() {
    std::cout.rdbuf(before_);
    std::cout.clear();
  }
  QuietOutput(const QuietOutput&) = delete;
  QuietOutput& operator=(const QuietOutput&) = delete;

 private:
  std::streambuf* before_;
};

[[noreturn]] void refuse_shards(const std::string& name) {
  throw strata::InputError("--shard and --merge",
                           "are for experiments over seeds, which " + name + " is not",
                           "run it on one machine");
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

/// Those of one long run or of real logs.
void run_whole(const std::string& name, const Options& options) {
  if (name == "year") return live_a_year(options);
  if (name == "place") return look_at_place(options);
  if (name == "door_times") return report_door_times(options.first, options.seeds);
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
  if (name == "starts") {
    (void)occasions(options);  // as many poses as logs
    return report_starts_of_logs(options.logs, options.poses);
  }
  if (name == "kidnapped") {
    (void)occasions(options);  // as many poses as logs
    return report_kidnapped_logs(options.logs, options.poses, {options.first, options.seeds});
  }
  if (!options.logs.empty()) (void)occasions(options);  // as many poses as logs
  if (name == "half_known") {
    return report_half_known_logs(options.logs, options.poses, options.runs,
                                  {options.first, options.seeds});
  }
  if (name == "verdicts") {
    return report_verdicts(options.runs, options.logs, options.poses, options.first);
  }
  if (name == "score") {
    return report_score({options.logs, options.poses, options.runs, options.scenarios,
                         options.scenario_names, options.first, options.seeds, options.out});
  }
}

/// What decides whether shards belong together, and to this command line.
shards::ShardInfo info_of(const std::string& name, const Options& options,
                          const shards::Shard& shard) {
  shards::ShardInfo info = shards::shard_info("strata-experiments " + name, shard, STRATA_VERSION);
  info.same["--seeds"] = std::to_string(options.seeds);
  info.same["--first-seed"] = std::to_string(options.first);
  info.same["--poor-poses"] = options.has_poor_poses ? "yes" : "no";
  info.same["--scenarios"] = shards::fingerprint(options.scenarios);
  return info;
}

void merge(const std::string& name, const Options& options) {
  const shards::ShardInfo own = info_of(name, options, {});
  const auto folders = shards::read_all_shards(options.merge, own.job, STRATA_VERSION);
  for (const auto& [key, value] : own.same) {
    if (folders.front().info.same.at(key) == value) continue;
    throw strata::InputError(folders.front().path.string(),
                             "is of another command: its " + key + " differs",
                             "give the options that the shards had");
  }
  shards::Units units(folders);
  if (!run_seed_experiment(name, options.of_seeds(), units)) refuse_shards(name);
}

void run_shard(const std::string& name, const Options& options) {
  const shards::Shard shard = shards::parse_shard(options.shard);
  shards::Units units(shard);
  const shards::ShardInfo info = info_of(name, options, shard);
  {
    const QuietOutput quiet;  // sums over some of the seeds say nothing
    if (!run_seed_experiment(name, options.of_seeds(), units)) refuse_shards(name);
  }
  std::filesystem::create_directories(options.out);
  shards::write_shard(info, units.results(), options.out);
  std::cout << name << ": shard " << options.shard << " has " << units.own() << " of "
            << units.count() << " units\n";
}

void run(const std::string& name, const Options& options) {
  if (!options.merge.empty()) return merge(name, options);
  if (!options.shard.empty()) return run_shard(name, options);
  const bool takes_logs = name == "starts" || name == "half_known" || name == "kidnapped";
  const bool has_logs = !options.logs.empty() || !options.runs.empty();
  if (takes_logs && has_logs) return run_whole(name, options);
  shards::Units units;
  if (!run_seed_experiment(name, options.of_seeds(), units)) run_whole(name, options);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "paper") {
    return strata::paper::paper_command(argc - 1, argv + 1, STRATA_SCENARIO_DIR);
  }
  Options options;
  std::string name;
  CLI::App app{"the experiments of docs/results.md; `paper` makes the papers' figures"};
  app.add_option("NAME", name, "which experiment")
      ->required()
      ->check(CLI::IsMember(experiment_names()));
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
  app.add_option("--log", options.logs,
                 "real logs of `place` (one or two), `decoders`, `verdicts`, `score`, "
                 "`single_scan`, `starts`, `kidnapped` and `half_known`");
  app.add_option("--runs", options.runs,
                 "folder of the three runs of `wean`, `verdicts`, `score` and `half_known`");
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
  app.add_option("--out", options.out, "where files of the year, the place or `topologies` go");
  app.add_option("--scenario", options.scenario_names,
                 "a file there, of several days, for `score` besides the offices");
  app.add_option("--scenarios", options.scenarios, "folder of the scenario files");
  CLI::Option* shard =
      app.add_option("--shard", options.shard,
                     "I/N: only the I-th of N parts of the seeds; its results go to --out");
  app.add_option("--merge", options.merge,
                 "folders of all N shards, with the options that they had: prints what one machine "
                 "would have printed")
      ->excludes(shard);
  CLI11_PARSE(app, argc, argv);
  try {
    run(name, options);
  } catch (const std::exception& error) {
    std::cerr << "strata-experiments: error: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
