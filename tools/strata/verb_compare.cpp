// SPDX-License-Identifier: Apache-2.0
/// `strata compare`: which map model localizes best in this building?
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "components/log/json_text.hpp"
#include "components/maps/map_models.hpp"
#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/pipeline/drive_replay.hpp"
#include "tools/pipeline/several_buildings.hpp"
#include "tools/strata/compare_job.hpp"
#include "tools/strata/compare_options.hpp"
#include "tools/strata/compare_shards.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/terminal_picture.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

using Options = CompareOptions;

/// Reads the logs and compares in them.
pipeline::CompareOutcome compare_logs(const Options& options, const pipeline::RunsInput& input,
                                      const pipeline::CompareConfig& config, VerbContext& context) {
  const PreparedComparison prepared = prepare_comparison(options, input, config, context);
  return pipeline::compare(prepared.runs, config, prepared.job);
}

/// The map and, of the model with the least error, its first run in the first drive.
void show_best(const pipeline::CompareOutcome& outcome, VerbContext& context) {
  const auto& models = outcome.comparison.models;
  const auto best =
      std::min_element(models.begin(), models.end(), [](const auto& a, const auto& b) {
        return pipeline::mean_error_m(a) < pipeline::mean_error_m(b);
      });
  if (best == models.end() || best->runs.empty()) return;
  show_map(outcome.maps.filtered, {&best->runs.front().estimates, 1}, context);
}

/// Each log by itself, then all in one table.
void compare_buildings(const Options& options, const pipeline::CompareConfig& config,
                       VerbContext& context) {
  const std::string settings = settings::write_yaml(config);
  ResultDirectory out(options.out, "comparison", context);
  std::vector<pipeline::Building> buildings;
  report::Drawings drawings;
  for (std::size_t i = 0; i < options.input.logs.size(); ++i) {
    pipeline::CompareOutcome outcome =
        compare_logs(options, building_input(options, i), config, context);
    pipeline::Building building{building_folder(options, i), {}};
    std::filesystem::create_directories(out.path() / building.folder);
    pipeline::write_report(outcome, settings, out.path() / building.folder, &drawings);
    if (!options.json) show_best(outcome, context);
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
  context.clear_progress();
  std::cout << pipeline::verdict(joint, pipeline::paired_tests(joint)) << '\n';
}

/// Where to look.
void note_places(const Options& options, VerbContext& context) {
  const std::filesystem::path out(options.out);
  const bool plays = std::filesystem::exists(out / pipeline::kReplayPage);
  context.note("report: " + (out / "report.html").string() +
               (plays ? "; the drive plays in " + (out / pipeline::kReplayPage).string() : ""));
}

void run_compare(const Options& options, VerbContext& context) {
  if (!options.merge.empty()) {
    merge_shards(options, context);
    return note_places(options, context);
  }
  require_one_way(options);
  const pipeline::CompareConfig config = compare_config_of(options, context);
  if (!options.shard.empty()) return compare_shard(options, config, context);
  if (options.buildings) {
    compare_buildings(options, config, context);
  } else {
    ResultDirectory out(options.out, "comparison", context);
    const pipeline::CompareOutcome outcome =
        compare_logs(options, input_of(options), config, context);
    report::Drawings drawings;
    pipeline::write_report(outcome, settings::write_yaml(config), out.path(), &drawings);
    out.commit();
    warn(context, drawings.what_is_missing());
    const auto tests = pipeline::paired_tests(outcome.comparison);
    if (options.json) {
      std::cout << log::json_text(pipeline::to_json(outcome.comparison, tests));
    } else {
      show_best(outcome, context);
      context.clear_progress();
      std::cout << pipeline::verdict(outcome.comparison, tests) << '\n';
    }
  }
  note_places(options, context);
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
  verb->add_option("--shard", options->shard,
                   "I/N: only the I-th of N parts, for --merge; the same command for each");
  CLI::Option* merge = verb->add_option(
      "--merge", options->merge, "folders of all N shards: what one machine would have written");
  // Everything that the shards know themselves.
  for (CLI::Option* option : verb->get_options()) {
    const std::string name = option->get_name();
    const bool stays = option == merge || name == "--out" || name == "--force" ||
                       name == "--json" || name == "--quiet" || name == "--threads" ||
                       name == "--help";
    if (!stays) merge->excludes(option);
  }
}

}  // namespace strata::tools
