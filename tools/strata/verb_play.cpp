// SPDX-License-Identifier: Apache-2.0
/// `strata play LOG`: publishes a recorded log as it was recorded, with a clock, to its end.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/log/log_reader.hpp"
#include "components/player/player.hpp"
#include "components/runtime/host.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/one_component.hpp"
#include "tools/strata/positive.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct PlayOptions {
  std::string log;
  std::string mode;
  std::vector<std::string> topics;
  std::optional<double> rate;
  std::optional<double> start_s;
  bool loop = false;
  NetworkOptions network;
};

/// A bag is played message by message; of a CARMEN log a robot's messages are made.
const char* usual_mode(const std::string& log) {
  return log::detect_format(log) == log::LogFormat::kCarmen ? "robot" : "messages";
}

void play(const PlayOptions& options, VerbContext& context) {
  const auto set = [&](YAML::Node& parameters) {
    parameters["log"] = options.log;
    if (!options.mode.empty()) {
      parameters["mode"] = options.mode;
    } else if (!parameters["mode"].IsDefined()) {
      parameters["mode"] = usual_mode(options.log);
    }
    if (!options.topics.empty()) parameters["topics"] = options.topics;
    if (options.rate) parameters["rate"] = *options.rate;
    if (options.start_s) parameters["start_s"] = *options.start_s;
    if (options.loop) parameters["loop"] = true;
  };
  const runtime::Composition composition =
      compose_one("strata::Player", "player", "play", options.network, set, context);
  const runtime::Registry registry = all_components();
  runtime::Host host(composition, composition.processes[0], registry, join(composition, context),
                     {});
  const auto& played = dynamic_cast<const player::Player&>(*host.components().front());
  host.activate();
  context.note("playing " + options.log + "; Ctrl-C ends it");
  std::vector<std::string> errors;
  const auto take_errors = [&] {
    for (std::string& error : host.take_errors()) errors.push_back(std::move(error));
  };
  while (!played.is_over() && !context.interrupt().wait_for(0.05)) {
    host.tick();
    take_errors();
  }
  host.stop();
  take_errors();
  if (!errors.empty())
    throw Error(options.log, "could not be played well: " + errors.front(),
                "see `strata info` for what is in it");
}

}  // namespace

void add_play(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<PlayOptions>(
      app, context, "play", "publish a recorded log over DDS, with a clock, to its end",
      "strata play office.clf --rate 2", play);
  verb->add_option("LOG", options->log, "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag")
      ->required();
  verb->add_option("--mode", options->mode,
                   "messages: every message of a bag as it was recorded; robot: its scans, with "
                   "odometry, tf and clock; messages when LOG is a bag")
      ->check(CLI::IsMember({"robot", "messages"}));
  verb->add_option("--topics", options->topics, "mode messages: only these; all when left out");
  verb->add_option("--rate", options->rate, "2: twice as fast as it was recorded")
      ->check(positive());
  verb->add_option("--start", options->start_s, "seconds from the beginning to begin at")
      ->check(CLI::Range(0.0, 4e9));
  verb->add_flag("--loop", options->loop, "begin again at the end");
  add_network_options(*verb, options->network);
}

}  // namespace strata::tools
