// SPDX-License-Identifier: Apache-2.0
/// `strata compare`: which map model localizes best in this building?
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/log/json_text.hpp"
#include "components/log/map_file.hpp"
#include "components/maps/map_models.hpp"
#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/pipeline/several_buildings.hpp"
#include "tools/strata/dds_localize.hpp"
#include "tools/strata/peer_localize.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

struct Options {
  pipeline::RunsInput input;
  std::vector<std::string> train;
  std::vector<std::string> test;
  std::vector<std::string> models;
  std::string out;
  std::optional<double> train_until_s;
  std::string map;
  std::string via = "direct";
  bool peers = false;
  bool json = false;
  bool buildings = false;
  int folds = 0;
  int seeds = 20;
  int jobs = 0;
};

std::vector<std::uint64_t> seeds_of(const Options& options, std::uint64_t first) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < options.seeds; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

std::string join(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : " ") + name;
  return joined;
}

void require_one_way(const Options& options) {
  const bool divided = !options.train.empty() || !options.test.empty();
  if (divided && !options.input.logs.empty()) {
    throw InputError("LOG", "is given beside --train and --test", "use one or the other");
  }
  if (divided && (options.train.empty() || options.test.empty())) {
    throw InputError("--train and --test", "belong together", "give both");
  }
  if (!divided && options.input.logs.empty()) {
    throw InputError("LOG", "is missing", "give a log, or --train and --test");
  }
  if (options.buildings && divided) {
    throw InputError("--buildings", "divides each log by itself", "leave out --train and --test");
  }
  if (options.folds > 0 && (divided || options.train_until_s)) {
    throw InputError("--folds", "divides the logs by itself",
                     "leave out --train, --test and --train-until");
  }
}

std::vector<pipeline::Split> make_splits(const Options& options, const pipeline::Runs& runs,
                                         const std::vector<std::string>& logs,
                                         const pipeline::CompareProtocol& protocol) {
  if (options.folds > 0) return pipeline::make_folds(runs, logs, options.folds);
  if (!options.train.empty()) {
    return {pipeline::split_by_run(runs, logs, static_cast<int>(options.train.size()))};
  }
  const double length_s = pipeline::elapsed_seconds(runs.observations).back();
  return {pipeline::split_by_time(runs, join(logs),
                                  options.train_until_s.value_or(protocol.train_share * length_s))};
}

pipeline::CompareConfig config_of(const Options& options, VerbContext& context) {
  auto config = read_config<pipeline::CompareConfig>(context);
  if (!options.models.empty()) config.protocol.models = options.models;
  if (!options.map.empty() && options.models.empty()) {
    for (const auto& model : maps::map_models().all()) {
      if (!model->is_learned()) config.protocol.models.push_back(model->shown_name());
    }
  }
  return config;
}

/// Reads the logs and compares in them.
pipeline::CompareOutcome compare_logs(const Options& options, const pipeline::RunsInput& input,
                                      const pipeline::CompareConfig& config, VerbContext& context) {
  pipeline::RunsInput reading = with_config(input, config.log);
  reading.needs_ros_stamps = options.via == "dds";
  const pipeline::Runs runs = pipeline::read_runs(reading, context.progress());
  note_reports(context, runs);
  if (runs.observations.empty()) {
    throw InputError(join(input.logs), "holds no scan in that time", "check --from and --to");
  }
  pipeline::CompareJob job;
  job.log = join(input.logs);
  job.splits = make_splits(options, runs, input.logs, config.protocol);
  job.seeds = seeds_of(options, context.options.seed);
  job.threads = context.options.threads;
  job.jobs = options.jobs;
  job.progress = context.progress();
  job.via = options.via;
  if (options.via == "dds") job.localize_with = localize_over_dds(context, options.out);
  if (options.peers) job.peers = peers_of_this_build(context, options.out);
  if (!options.map.empty()) job.given_map = log::read_map(options.map);
  return pipeline::compare(runs, config, job);
}

/// Each log by itself, then all in one table.
void compare_buildings(const Options& options, const pipeline::CompareConfig& config,
                       VerbContext& context) {
  const std::string settings = settings::write_yaml(config);
  ResultDirectory out(options.out, "comparison", context);
  std::vector<pipeline::Building> buildings;
  report::Drawings drawings;
  for (std::size_t i = 0; i < options.input.logs.size(); ++i) {
    pipeline::RunsInput input = options.input;
    input.logs = {options.input.logs[i]};
    for (auto* files : {&input.poses, &input.truths}) {
      if (files->empty()) continue;
      if (files->size() != options.input.logs.size()) {
        throw InputError("--poses and --truth", "are not given once per log",
                         "give them in the order of the logs");
      }
      *files = {(*files)[i]};
    }
    pipeline::CompareOutcome outcome = compare_logs(options, input, config, context);
    const std::string name = std::filesystem::path(input.logs[0]).filename().string();
    pipeline::Building building{std::to_string(i + 1) + "_" + name.substr(0, name.find('.')), {}};
    std::filesystem::create_directories(out.path() / building.folder);
    pipeline::write_report(outcome, settings, out.path() / building.folder, &drawings);
    building.comparison = std::move(outcome.comparison);
    buildings.push_back(std::move(building));
  }
  pipeline::write_joint_report(buildings, settings, out.path());
  out.commit();
  warn(context, drawings.what_is_missing());
  if (options.json) {
    std::cout << log::json_text(pipeline::joint_json(buildings));
    return;
  }
  const pipeline::Comparison joint = pipeline::join(buildings);
  std::cout << pipeline::verdict(joint, pipeline::paired_tests(joint)) << '\n';
}

void run_compare(const Options& options, VerbContext& context) {
  require_one_way(options);
  const pipeline::CompareConfig config = config_of(options, context);
  if (options.buildings) {
    compare_buildings(options, config, context);
  } else {
    ResultDirectory out(options.out, "comparison", context);
    pipeline::RunsInput input = options.input;
    for (const auto* logs : {&options.train, &options.test}) {
      input.logs.insert(input.logs.end(), logs->begin(), logs->end());
    }
    const pipeline::CompareOutcome outcome = compare_logs(options, input, config, context);
    report::Drawings drawings;
    pipeline::write_report(outcome, settings::write_yaml(config), out.path(), &drawings);
    out.commit();
    warn(context, drawings.what_is_missing());
    const auto tests = pipeline::paired_tests(outcome.comparison);
    if (options.json) {
      std::cout << log::json_text(pipeline::to_json(outcome.comparison, tests));
    } else {
      std::cout << pipeline::verdict(outcome.comparison, tests) << '\n';
    }
  }
  context.note("report: " + options.out + "/report.html");
}

}  // namespace

void add_compare(CLI::App& app, VerbContext& context) {
  const auto [verb, options] =
      add_verb<Options>(app, context, "compare", "which map localizes best in this building?",
                        "strata compare week.clf --seeds 20 --out comparison", run_compare);
  verb->add_option("LOG", options->input.logs, "learn on the first part, localize on the rest");
  verb->add_option("--train", options->train, "logs to learn from");
  verb->add_option("--test", options->test, "logs to localize in");
  verb->add_option("--out", options->out, "folder for report.html, comparison.json and figures")
      ->required();
  add_force(*verb, context);
  verb->add_option("--models", options->models,
                   "models to compare (comma separated)\n" +
                       maps::map_models().help([](const auto&) { return true; }))
      ->delimiter(',');
  verb->add_option("--train-until", options->train_until_s, "seconds that belong to learning");
  verb->add_option("--folds", options->folds,
                   "cut into this many parts (logs, or pieces of one log); localize in each with "
                   "maps of the others")
      ->check(CLI::Range(2, 100));
  verb->add_option("--map", options->map,
                   "map_server YAML of a map to compare with, as model `map`; in the frame of the "
                   "truth, or of the poses");
  verb->add_option(
          "--via", options->via,
          "direct, or dds: every run is a strata::Localizer component, one after the other")
      ->capture_default_str()
      ->check(CLI::IsMember({"direct", "dds"}));
  verb->add_flag("--peers", options->peers,
                 "beside our models, other projects' localizers in the occupancy map: peer_mrpt");
  verb->add_option("--jobs", options->jobs,
                   "runs of the localizer at once; the results do not depend on it (default: as "
                   "--threads)")
      ->check(CLI::Range(1, 256));
  verb->add_flag("--buildings", options->buildings,
                 "every LOG is a building of its own: compared by itself, then in one table");
  verb->add_flag("--json", options->json, "comparison.json on stdout, instead of the verdict");
  verb->add_option("--seeds", options->seeds, "runs of the localizer per model")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
