// SPDX-License-Identifier: Apache-2.0
/// `strata learn LOG... --out MAPS`: every map from one or several runs in one building.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "components/log/folder_lock.hpp"
#include "components/log/log_config.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/summary.hpp"
#include "components/settings/settings.hpp"
#include "components/site/learn_limits.hpp"
#include "components/site/zones.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/learn_pictures.hpp"
#include "tools/pipeline/learn_within.hpp"
#include "tools/pipeline/truth_frame.hpp"
#include "tools/report/drawings.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/learn_guard.hpp"
#include "tools/strata/learned_folder.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/terminal_picture.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

struct LearnOptions {
  pipeline::RunsInput input;
  std::string out;
  std::string update;
  std::string zones;
  std::string only_in;
  bool anew = false;
  bool again = false;
  std::vector<std::string> only;
  bool pictures = false;
};

/// What learning reads, beside what the logs leave open.
struct Config {
  maps::LearnConfig learn;
  log::LogConfig log;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    maps::LearnConfig::describe(c.learn, v);
    v.group("log", c.log, "what logs do not say of themselves");
  }
};

pipeline::LearnParts parts_of(const std::vector<std::string>& only) {
  if (only.empty()) return {};
  for (const std::string& part : only) {
    if (part != "em" && part != "patch" && part != "timescale") {
      throw InputError("--only " + part, "is unknown", "choose among em, patch, timescale");
    }
  }
  const auto has = [&](const char* part) {
    return std::find(only.begin(), only.end(), part) != only.end();
  };
  return {.patch = has("patch"), .timescale = has("timescale")};
}

std::vector<pipeline::LearnedPose> poses_of(const slam::SlamResult& result) {
  std::vector<pipeline::LearnedPose> poses;
  for (const PosedScan& scan : result.scans) {
    poses.push_back({scan.run, scan.scan.stamp, scan.map_from_robot});
  }
  return poses;
}

/// One a run.
std::vector<report::TerminalWay> ways_of(const slam::SlamResult& result) {
  std::vector<report::TerminalWay> ways;
  const PosedScan* last = nullptr;
  for (const PosedScan& scan : result.scans) {
    if (last == nullptr || last->run != scan.run) ways.emplace_back();
    ways.back().push_back(scan.map_from_robot);
    last = &scan;
  }
  return ways;
}

bool updates_in_place(const LearnOptions& options) {
  std::error_code error;
  return !options.update.empty() && std::filesystem::equivalent(options.update, options.out, error);
}

/// Of a folder that may be missing for the moment: a kill took its name.
void require_possible(const std::string& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) || !error) return;
  throw InputError(folder, "cannot be reached: " + error.message(),
                   "give a folder that `strata learn` wrote");
}

/// Else of two that go on from one folder at once, what the first learned would be lost.
void wait_for_others(const std::string& folder, VerbContext& context,
                     std::optional<log::FolderLock>& lock) {
  bool is_told = false;
  lock.emplace(folder, [&](const std::string& holder) {
    if (!std::exchange(is_told, true)) {
      context.note("waits for " + holder + ", which updates " + folder);
    }
    return !context.interrupt().wait_for(0.1);
  });
}

/// What the zones and the region that are named keep learning from.
pipeline::LearnWithin limits_of(const LearnOptions& options, const maps::LearnConfig& config) {
  if (options.zones.empty() && options.only_in.empty()) return {};
  const double resolution_m = config.slam.beam_filter.resolution_m;
  pipeline::LearnWithin within;
  if (!options.zones.empty()) {
    site::LearnLimits limits = site::learn_limits(site::zones_at(options.zones), resolution_m);
    within.never = std::move(limits.never);
    within.static_only = std::move(limits.static_only);
  }
  if (!options.only_in.empty()) {
    within.only = pipeline::cells_of_region(site::read_region(options.only_in), resolution_m,
                                            options.only_in);
    within.forgets = options.anew;
  }
  if (!options.update.empty()) within.before = pipeline::read_base(options.update);
  return within;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : " ") + text;
  return all;
}

std::string sentence(const nlohmann::json& summary, const pipeline::LearnResult& result,
                     const LearnOptions& options) {
  using report::fixed;
  const nlohmann::json& cost = summary["cost"];
  return "learned from " + counted(summary["scans"].get<std::size_t>(), "scan") + " over " +
         fixed(summary["path_m"], 2) + " m in " + fixed(cost["wall_s"], 1) + " s, " +
         fixed(cost["real_time_factor"], 0) + " times real time; " +
         (parts_of(options.only).patch
              ? counted(result.patches.submaps.size(), "place") + " that may change; "
              : "") +
         (result.patches.unrecurring.empty() ? ""
                                             : counted(result.patches.unrecurring.size(), "place") +
                                                   " left out, where what came never returned; ") +
         "maps in " + options.out + ", drawn in " +
         (std::filesystem::path(options.out) / pipeline::kMapPicture).string();
}

void run_learn(const LearnOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto [config, log_config] = read_config<Config>(context);
  const pipeline::LearnParts parts = parts_of(options.only);
  std::optional<maps::EarlierRuns> earlier;
  std::optional<log::FolderLock> lock;
  if (!options.update.empty()) {
    require_possible(options.update);
    OutputDirectory::put_back(options.update);
  }
  if (updates_in_place(options)) wait_for_others(options.out, context, lock);
  // Told before the work: what cannot be written, or must not be replaced.
  ResultDirectory out(options.out, "maps", context);
  if (!options.update.empty()) earlier = maps::read_earlier_runs(options.update);
  const pipeline::LearnWithin limits = limits_of(options, config);
  const int first_run = earlier ? earlier->next_run : 0;
  const std::size_t earlier_runs = earlier ? runs_in(options.update) : 0;
  require_no_more_runs(options.out, earlier_runs + options.input.logs.size(), context);
  const bool guards = earlier && !context.options.force;
  if (guards) require_no_lost_parts(options.out, parts);
  pipeline::Runs runs =
      pipeline::read_runs(with_config(options.input, log_config), context.progress(), first_run);
  note_reports(context, runs);
  if (guards && !updates_in_place(options)) {
    require_no_lost_runs(options.out, options.update, *earlier, runs.observations);
  }
  std::vector<std::string> logs = options.input.logs;
  if (earlier && !options.again) {
    logs = leave_out_repeated(runs, logs, first_run, *earlier, context);
  }
  if (logs.empty() && updates_in_place(options)) {
    context.note("nothing new: " + options.out + " stays as it is");
    return;
  }
  const pipeline::LearnResult result = pipeline::learn_within(
      limits, runs.observations, runs.poses, config, parts, context.options.seed,
      context.options.threads, context.progress(), earlier ? &*earlier : nullptr);
  if (earlier) require_a_place(result.slam, options.update, first_run);
  for (const std::string& warning : result.slam.warnings) context.note("warning: " + warning);
  for (const int run : result.slam.unplaced_runs) {
    const std::string& log = options.input.logs[static_cast<std::size_t>(run - first_run)];
    warn(context, "run " + std::to_string(run) + " could not be placed in the map of the first: " +
                      log + " was left out; give --poses");
  }
  // The frame of the truth is that of the first truth given: later ones are in it too.
  const auto frame = earlier && earlier->map_from_truth
                         ? earlier->map_from_truth
                         : pipeline::map_from_truth(runs, poses_of(result.slam));
  if (earlier) logs.insert(logs.begin(), earlier->log);
  const auto draw_more = [&](const std::filesystem::path& maps, report::Drawings& drawings) {
    if (!options.pictures) return;
    drawings.add(maps / "pictures", [&] {
      pipeline::write_learn_pictures(maps / "pictures", result.slam, config.slam.beam_filter);
    });
  };
  const nlohmann::json summary = write_learned(
      out, result, parts,
      {joined(logs), frame, &meter, earlier ? earlier->thinned : std::vector<maps::ThinnedRun>(),
       maps::summarize_reading(runs.reports)},
      context, draw_more);
  if (context.options.quiet) return;
  show_map(result.slam.filtered, ways_of(result.slam), context);
  context.clear_progress();
  std::cout << sentence(summary, result, options) << '\n';
}

}  // namespace

void add_learn(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<LearnOptions>(
      app, context, "learn", "learn all maps from one or several runs in one building",
      "strata learn monday.clf tuesday.clf --out maps", run_learn);
  verb->add_option("LOG", options->input.logs,
                   "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag; in order")
      ->required();
  verb->add_option("--out", options->out, "folder for the maps")->required();
  add_force(*verb, context);
  verb->add_option("--update", options->update,
                   "folder of maps learned before: go on from them; their runs come first");
  verb->add_option("--zones", options->zones,
                   "site, or GeoJSON file, whose zones of kind learn say where nothing is learned "
                   "(what was known stays), or nothing that changes");
  verb->add_flag("--again", options->again,
                 "count a log once more that was learned already; else it is left out")
      ->needs("--update");
  CLI::Option* only_in =
      verb->add_option("--only-in", options->only_in,
                       "GeoJSON file of polygons in metres: the maps stay as they are elsewhere")
          ->needs("--update");
  verb->add_flag("--anew", options->anew,
                 "what earlier runs saw in that region is forgotten: it was rebuilt")
      ->needs(only_in);
  verb->add_option("--only", options->only, "em, patch, timescale (comma separated)")
      ->delimiter(',');
  verb->add_flag("--pictures", options->pictures,
                 "beside the maps, pictures/report.html: the map before and after the beam filter, "
                 "the likelihood and the map round by round");
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
