// SPDX-License-Identifier: Apache-2.0
/// `strata replay LOG --composition F --out DIR`: recorded logs through the components in lockstep,
/// and a comparison with what came out before.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "components/maps/localization_files.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/summary.hpp"
#include "tools/expect/compare_results.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/incident_replay.hpp"
#include "tools/strata/positive.hpp"
#include "tools/strata/replay_fit.hpp"
#include "tools/strata/replay_session.hpp"
#include "tools/strata/replay_truths.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/view_host.hpp"
#include "tools/strata/warning.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

struct ReplayOptions {
  pipeline::RunsInput input;
  std::string composition;
  std::string out;
  std::string expect;
  bool accept = false;
  std::vector<std::string> topics;
  std::optional<double> learn_until_s;
  int view_port = 0;  ///< 0: no live view
  double rate = 0.0;  ///< 0: as fast as the components are
};

/// How many scans are for learning, when the rest is to be localized.
std::size_t learned_scans(const ReplayOptions& options, const pipeline::Runs& runs) {
  const std::vector<double> elapsed_s = pipeline::elapsed_seconds(runs.observations);
  const auto end = std::upper_bound(elapsed_s.begin(), elapsed_s.end(), *options.learn_until_s);
  if (end == elapsed_s.begin() || end == elapsed_s.end()) {
    throw InputError("--learn-until " + report::fixed(*options.learn_until_s, 1),
                     "leaves nothing to learn from or nothing to localize",
                     "choose a time within the log's " + report::fixed(elapsed_s.back(), 1) + " s");
  }
  return static_cast<std::size_t>(end - elapsed_s.begin());
}

/// The kind of results that a component saves; empty: none.
std::string kind_saved_by(const std::string& type) {
  if (type == "strata::Localizer") return "localization";
  if (type == "strata::TopologyMapper") return "topology";
  if (type == "strata::VolumeMapper") return "volume";
  const bool learns = type == "strata::ScanMatcher" || type == "strata::PatchLearner" ||
                      type == "strata::TimescaleMemory";
  return learns ? "maps" : "";
}

/// Before the work, as far as the composition tells: what components save into the top of --out
/// replaces nothing of another kind, and nothing of the user's.
void require_place(const ReplayOptions& options, const runtime::Composition& composition,
                   const VerbContext& context) {
  std::set<std::string> saved;
  for (const auto& process : composition.processes) {
    for (const auto& entry : process.components) {
      const bool is_at_top = runtime::out_folder_of(entry, composition).empty() &&
                             !entry.parameters["out_subfolder"].IsDefined();
      if (is_at_top) saved.insert(kind_saved_by(entry.type));
    }
  }
  const std::string there = kind_of(options.out);
  // In the order of kind_of, for those that save several.
  for (const char* kind : {"maps", "localization", "topology", "volume"}) {
    if (!saved.contains(kind)) continue;
    require_kind(options.out, kind, context);
    if (there == kind) return;
  }
}

/// Plays everything and has the components save into `out`.
void replay_into(const fs::path& out, const ReplayOptions& options, VerbContext& context,
                 runtime::Composition composition, const pipeline::Runs& runs) {
  const pipeline::CostMeter meter;
  ReplaySession session(context, std::move(composition), options.composition);
  if (!options.topics.empty()) session.record(options.topics, out / expect::kTopicsFolder);
  ReplayTruths truths(!options.input.truths.empty(), runs, session);
  // Stamps of several logs may overlap: clouds go with one only.
  const bool is_one = options.input.logs.size() == 1;
  session.connect(runs, !is_one || !options.input.poses.empty(),
                  is_one ? std::optional<fs::path>(options.input.logs.front()) : std::nullopt);
  truths.wait_until_heard();
  // Now that everybody has found everybody: its readers would be taken for those that are waited
  // for.
  const auto view = view_of(session.composition(), session.participant(),
                            {.port = options.view_port, .keep_newest = true}, context);
  std::size_t begin = 0;
  if (options.learn_until_s) {
    begin = learned_scans(options, runs);
    session.play(0, begin, options.rate);
    session.finish(out);
    truths.align(out);
  }
  session.play(begin, runs.observations.size(), options.rate);
  session.finish(out);
  if (!options.learn_until_s) truths.align(out);
  truths.write(out);
  session.stop();
  for (const std::string& warning : fit_warnings(out, session.composition(), runs)) {
    warn(context, warning);
  }
  const pipeline::Cost cost = meter.read();
  std::string logs;
  for (const std::string& log : options.input.logs) logs += (logs.empty() ? "" : " ") + log;
  for (const fs::path& folder : folders_with(out, maps::kStoreFile)) {
    maps::write_summary(folder, logs, {cost.wall_s, cost.cpu_s, cost.peak_rss_mb},
                        maps::summarize_reading(runs.reports));
  }
}

std::vector<expect::Difference> compare(const fs::path& out, const std::string& expected) {
  return expect::compare_results(expect::read_results(expected), expect::read_results(out),
                                 expect::load_tolerances(expected));
}

/// Throws Error with the first difference; prints every file and topic that differs.
void require_none(const std::vector<expect::Difference>& differences, const ReplayOptions& options,
                  VerbContext& context) {
  if (differences.empty()) {
    context.note("as expected in " + options.expect);
    return;
  }
  for (const expect::Difference& difference : differences) {
    std::cout << expect::describe(difference) << '\n';
  }
  const expect::Difference& first = differences.front();
  throw Error(options.expect, "the replay differs, first in " + expect::describe(first),
              "mend it, or refresh what is expected with --accept");
}

/// What was recorded into the expected results is recorded again, also to refresh them.
void take_topics_of_expected(ReplayOptions& options) {
  if (options.expect.empty() || !options.topics.empty()) return;
  if (fs::is_directory(options.expect)) {
    options.topics = expect::recorded_topics(options.expect);
  } else if (!options.accept) {
    throw InputError("--expect " + options.expect, "is no folder", "make it first with --accept");
  }
}

/// What a localizer kept of itself in an incident needs no composition.
bool replays_incident(const ReplayOptions& options) {
  return options.composition.empty() && options.input.logs.size() == 1 &&
         is_incident(options.input.logs.front());
}

void replay(ReplayOptions options, VerbContext& context) {
  if (replays_incident(options)) {
    return replay_and_tell({options.input.logs.front(), {}}, options.out, context);
  }
  if (options.composition.empty()) {
    throw ConfigError("--composition", "is missing", "name a composition file");
  }
  if (options.out.empty() && options.expect.empty()) {
    throw ConfigError("--out", "is missing", "name a folder for what the components save");
  }
  if (options.accept && options.expect.empty()) {
    throw ConfigError("--accept", "needs --expect", "name the folder of expected results");
  }
  take_topics_of_expected(options);
  // Without --out the results are needed only for the comparison.
  OutputDirectory out(options.out.empty() ? options.expect + ".replayed" : options.out,
                      context.staged());
  if (!options.out.empty()) {
    require_no_more_runs(options.out, options.input.logs.size(), context);
  }
  runtime::Composition composition = load_composition(options.composition, context);
  if (!options.out.empty()) require_place(options, composition, context);
  options.input.needs_ros_stamps = true;
  const pipeline::Runs runs = pipeline::read_runs(options.input, context.progress());
  note_reports(context, runs);
  replay_into(out.path(), options, context, std::move(composition), runs);
  // Of components that are not ours it is known only now.
  if (!options.out.empty()) require_kind(options.out, kind_of(out.path()), context);
  std::vector<expect::Difference> differences;
  if (options.accept) {
    expect::accept_results(out.path(), options.expect);
    context.note("accepted into " + options.expect);
  } else if (!options.expect.empty()) {
    differences = compare(out.path(), options.expect);
  }
  if (!options.out.empty()) {
    out.commit();
    context.note("wrote " + options.out);
  }
  if (!options.accept && !options.expect.empty()) require_none(differences, options, context);
}

}  // namespace

void add_replay(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<ReplayOptions>(
      app, context, "replay", "send recorded logs through the components, in lockstep over DDS",
      "strata replay office.clf --composition components/config/mapping.yaml --out maps\n"
      "  strata replay office.clf --composition localize.yaml --expect tests/office",
      replay);
  verb->add_option("log", options->input.logs, "CARMEN logs, rosbag2 or MCAP; in order")
      ->required();
  verb->add_option("--composition", options->composition,
                   "composition file; an incident may do without: its localizers' poses are then "
                   "found again from what they kept of themselves, and compared bit by bit");
  verb->get_option("--set")->description(kCompositionSetHelp);
  verb->get_option("--config")->description(kCompositionConfigHelp);
  verb->add_option("--out", options->out, "folder for what the components save");
  add_force(*verb, context);
  verb->add_option("--expect", options->expect,
                   "folder with the results of before: compare, and fail when they differ by more "
                   "than its tolerances.yaml allows");
  verb->add_flag("--accept", options->accept, "refresh what is expected instead of comparing");
  verb->add_option("--topics", options->topics,
                   "record these too, into OUT/topics; with --expect those recorded before");
  verb->add_option(
      "--learn-until", options->learn_until_s,
      "seconds from the start: learn from what comes before, then localize the rest in "
      "it (localizers without `maps`)");
  verb->add_option("--rate", options->rate,
                   "1: as fast as it was, nights cut short; as fast as possible when left out")
      ->check(positive());
  add_view_option(*verb, options->view_port);
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
