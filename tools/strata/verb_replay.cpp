// SPDX-License-Identifier: Apache-2.0
/// `strata replay LOG --composition F --out DIR`: a recorded log through the components in
/// lockstep.
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "components/log/log_reader.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/conductor.hpp"
#include "components/runtime/host.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/strata/all_components.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct ReplayOptions {
  std::string log;
  std::string composition;
  std::string out;
  double rate = 0.0;  ///< 0: as fast as the components are
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
};

/// The verb plays; a player in the composition would play twice.
void leave_out_players(runtime::Composition& composition) {
  for (runtime::ProcessEntry& process : composition.processes) {
    std::erase_if(process.components,
                  [](const auto& entry) { return entry.type == "strata::Player"; });
  }
  std::erase_if(composition.processes, [](const auto& entry) { return entry.components.empty(); });
}

std::vector<std::string> component_names(const runtime::Composition& composition) {
  std::vector<std::string> names;
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      names.push_back(bus::expand_name(entry.name, entry.node_namespace, entry.name));
    }
  }
  return names;
}

player::Outputs make_outputs(runtime::Conductor& conductor, const std::string& scope) {
  const auto named = [&](const std::string& topic) {
    return bus::expand_name(topic, scope, "player");
  };
  player::Outputs outputs;
  outputs.clock = conductor.advertise<rosgraph_msgs::msg::Clock>("/clock");
  outputs.tf_static = conductor.advertise<tf2_msgs::msg::TFMessage>("/tf_static");
  outputs.tf = conductor.advertise<tf2_msgs::msg::TFMessage>("/tf");
  outputs.odometry = conductor.advertise<nav_msgs::msg::Odometry>(named("odom"));
  outputs.scan = conductor.advertise<sensor_msgs::msg::LaserScan>(named("scan"));
  return outputs;
}

/// Waits until a scan is due; false when interrupted.
class Pace {
 public:
  Pace(double rate, VerbContext& context) : rate_(rate), context_(context) {}
  void wait_for(Duration since_start) {
    if (rate_ <= 0.0) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    const double left_s = since_start.seconds() / rate_ - elapsed.count();
    if (left_s > 0.0 && context_.interrupt().wait_for(left_s)) throw Cancelled("replay");
  }

 private:
  double rate_;
  VerbContext& context_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void play(const ReplayOptions& options, VerbContext& context, runtime::Conductor& conductor,
          player::LogPlayer& player) {
  Pace pace(options.rate, context);
  const auto& observations = player.observations();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    pace.wait_for(observations[i].scan.stamp - observations.front().scan.stamp);
    player.publish(i);
    conductor.cycle();
    report_progress(context.progress(), "replay", i + 1, observations.size());
  }
}

/// The MAPS folders that the components left: the top, or one a namespace.
std::vector<std::filesystem::path> maps_folders(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    if (entry.path().filename() == maps::kStoreFile) folders.push_back(entry.path().parent_path());
  }
  return folders;
}

void replay(const ReplayOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  refuse_config(context.options, kConfigRemedy);
  runtime::Composition composition =
      runtime::load_composition(options.composition, context.options.overrides);
  leave_out_players(composition);
  log::ReadOptions read;
  read.from_s = options.from_s;
  read.to_s = options.to_s;
  read.progress = context.progress();
  std::vector<Observation> observations = log::read_observations(options.log, read);
  OutputDirectory out(options.out, context.staged());

  const auto participant = runtime::make_participant(composition);
  ProcessGroup group;
  std::unique_ptr<runtime::Host> host;
  const runtime::Registry registry = all_components();
  if (composition.processes.size() == 1) {
    host = std::make_unique<runtime::Host>(
        composition, composition.processes[0], registry, participant,
        runtime::HostOptions{runtime::FeedMode::kLockstep, context.options.seed,
                             context.options.threads});
  } else {
    for (const runtime::ProcessEntry& process : composition.processes) {
      group.start(process.name, child_arguments(options.composition, process.name, context, true));
    }
  }
  runtime::Conductor conductor(participant, component_names(composition),
                               [&] { return !context.interrupt().requested() && group.all_run(); });
  player::LogPlayer player(std::move(observations),
                           make_outputs(conductor, composition.node_namespace));
  conductor.connect();
  play(options, context, conductor, player);
  conductor.finish(std::filesystem::absolute(out.path()));
  if (host) host->stop();
  group.stop();
  const pipeline::Cost cost = meter.read();
  for (const std::filesystem::path& folder : maps_folders(out.path())) {
    maps::write_summary(folder, options.log, {cost.wall_s, cost.cpu_s, cost.peak_rss_mb});
  }
  out.commit();
  context.note("wrote " + options.out);
}

}  // namespace

void add_replay(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* verb = add_verb(
      app, context, "replay", "Send a recorded log through the components, in lockstep over DDS",
      "strata replay office.clf --composition components/config/mapping.yaml --out maps",
      [options, &context] { replay(*options, context); });
  verb->add_option("log", options->log, "CARMEN log, rosbag2 or MCAP")->required();
  verb->add_option("--composition", options->composition, "composition file")->required();
  verb->get_option("--set")->description(kCompositionSetHelp);
  verb->add_option("--out", options->out, "folder for what the components save")->required();
  verb->add_option("--rate", options->rate, "1: wall-clock; as fast as possible when left out")
      ->check(CLI::PositiveNumber);
  verb->add_option("--from", options->from_s, "seconds from the start");
  verb->add_option("--to", options->to_s, "seconds from the start");
}

}  // namespace strata::tools
