// SPDX-License-Identifier: Apache-2.0
/// `strata record --out BAG`: records topics into a rosbag2 bag until Ctrl-C.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/recorder/recorder.hpp"
#include "components/runtime/host.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/one_component.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct RecordOptions {
  std::string out;
  std::vector<std::string> topics;
  std::string storage;
  std::optional<double> split_mb;
  std::optional<double> split_s;
  NetworkOptions network;
};

void record(const RecordOptions& options, VerbContext& context) {
  const auto set = [&](YAML::Node& parameters) {
    parameters["out"] = options.out;
    if (!options.storage.empty()) parameters["storage"] = options.storage;
    if (options.split_mb) parameters["split_mb"] = *options.split_mb;
    if (options.split_s) parameters["split_s"] = *options.split_s;
    if (!options.topics.empty()) parameters["topics"] = options.topics;
  };
  const runtime::Composition composition =
      compose_one("strata::Recorder", "recorder", "record", options.network, set, context);
  if (composition.network.is_alone) {
    context.note(
        "note: no other process is heard: the environment says ROS_AUTOMATIC_DISCOVERY_RANGE=OFF; "
        "name a --transport to record from others");
  }
  const runtime::Registry registry = all_components();
  runtime::Host host(composition, composition.processes[0], registry, join(composition, context),
                     {});
  const auto& recorder = dynamic_cast<const recorder::Recorder&>(*host.components().front());
  host.activate();
  context.interrupt().set_grace(std::chrono::duration<double>(kStopPatience).count());
  context.note("recording into " + options.out + "; Ctrl-C ends it");
  std::string first_error;  // that costs the bag something, where one does
  bool is_told = false;
  const auto tell_errors = [&] {
    for (const std::string& error : host.take_errors()) {
      context.note("warning: " + error);
      if (first_error.empty() || !is_told) {
        first_error = error;
        is_told = !recorder.is_whole();
      }
    }
  };
  while (!context.interrupt().wait_for(0.1)) {
    host.tick();
    tell_errors();  // and goes on: there may be room again
  }
  host.components().front()->deactivate();
  tell_errors();  // the bag's last chunk and its index are written at the end
  const bool is_whole = recorder.is_whole();
  const std::string unpublished = recorder.unpublished();
  const std::string silent = recorder.silent();
  host.stop();
  if (!silent.empty()) context.note("note: nothing came of " + silent);
  if (!is_whole) throw OutputError(options.out, first_error, "then record again");
  if (!unpublished.empty()) {
    throw OutputError(options.out, "lacks what nobody published: " + unpublished,
                      "name topics as `strata doctor` lists them");
  }
}

}  // namespace

void add_record(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<RecordOptions>(
      app, context, "record", "record topics into a rosbag2 bag until Ctrl-C",
      "strata record --out bag --topics /scan /odom", record);
  verb->add_option("--out", options->out, "bag folder to write")->required();
  verb->add_option("--topics", options->topics, "topics; all when left out");
  verb->add_option("--storage", options->storage, "sqlite3 or mcap");
  verb->add_option("--split-mb", options->split_mb, "begin another file when one holds this much");
  verb->add_option("--split-s", options->split_s, "... or spans this many seconds");
  add_network_options(*verb, options->network);
}

}  // namespace strata::tools
