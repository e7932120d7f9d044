// SPDX-License-Identifier: Apache-2.0
/// `strata simulate SCENARIO.yaml --out DIR`: a log with ground truth.
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "components/log/carmen.hpp"
#include "components/log/log_writer.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tools/report/drawings.hpp"
#include "tools/report/image.hpp"
#include "tools/simulate/simulation.hpp"
#include "tools/simulate/space_log.hpp"
#include "tools/simulate/truth.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

struct SimulateOptions {
  std::string scenario;
  std::string out;
  std::string storage = "sqlite3";
  bool per_day = false;
};

/// Log, bag and true trajectory of the days [first, last).
void write_logs(const fs::path& folder, const simulate::Simulation& simulation, std::size_t first,
                std::size_t last, log::BagStorage storage) {
  log::LogContent content;
  std::vector<log::StampedPose> truth;
  for (std::size_t day = first; day < last; ++day) {
    for (const simulate::SimulatedScan& scan : simulation.days[day].scans) {
      content.observations.push_back(scan.observation);
      truth.push_back({scan.observation.scan.stamp, scan.map_from_robot});
    }
  }
  log::write_carmen(folder / "log.clf", content);
  log::BagOptions format{.storage = storage};
  if (storage == log::BagStorage::kMcap) format.chunks = log::BagCompression::kZstd;
  log::write_bag(folder / "bag", content, format,
                 simulate::space_messages(simulation, first, last));
  log::write_trajectory(folder / "truth.tum", truth);
}

void run_simulate(const SimulateOptions& options, VerbContext& context) {
  if (!context.options.config_file.empty()) {
    throw ConfigError("--config", "does not go with a scenario",
                      "put the settings into " + options.scenario + ", or use --set");
  }
  std::vector<std::string> notes;
  const simulate::ScenarioConfig scenario =
      simulate::load_scenario(options.scenario, context.options.overrides, &notes);
  for (const std::string& note : notes) context.note("note: " + note);
  const auto storage =
      options.storage == "mcap" ? log::BagStorage::kMcap : log::BagStorage::kSqlite3;
  ResultDirectory out(options.out, "simulation", context);
  const simulate::Simulation simulation =
      simulate::simulate(scenario, context.options.seed, context.progress());
  const std::size_t days = simulation.days.size();
  write_logs(out.path(), simulation, 0, days, storage);
  for (std::size_t day = 0; options.per_day && day < days; ++day) {
    report_progress(context.progress(), "write days", day, days);
    const fs::path folder = out.path() / ("day_" + std::to_string(day + 1));
    fs::create_directories(folder);
    write_logs(folder, simulation, day, day + 1, storage);
  }
  report::write_file(out.path() / "states.json", simulate::states_json(simulation));
  report::Drawings drawings;
  const fs::path world = out.path() / "world.png";
  drawings.add(world,
               [&] { report::write_file(world, report::encode_png(draw_world(simulation))); });
  out.commit();
  warn(context, drawings.what_is_missing());
  std::size_t scans = 0;
  for (const simulate::SimulatedDay& day : simulation.days) scans += day.scans.size();
  context.note(options.out + ": " + std::to_string(scans) + " scans over " + std::to_string(days) +
               (days == 1 ? " day, " : " days, ") + std::to_string(simulation.objects.size()) +
               " doors and boxes");
}

}  // namespace

void add_simulate(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<SimulateOptions>(
      app, context, "simulate",
      "a log with ground truth from a world with people, doors, moved boxes",
      "strata simulate tools/simulate/scenarios/office.yaml --out office --seed 3", run_simulate);
  verb->add_option("SCENARIO", options->scenario, "YAML file (version: 1)")->required();
  verb->add_option("--out", options->out,
                   "folder for log.clf, bag/, truth.tum, states.json, world.png")
      ->required();
  add_force(*verb, context);
  verb->add_option("--storage", options->storage, "of the bag")
      ->check(CLI::IsMember({"sqlite3", "mcap"}))
      ->capture_default_str();
  verb->add_flag("--per-day", options->per_day,
                 "also day_1/, day_2/, ... with log, bag and truth of that day alone");
}

}  // namespace strata::tools
