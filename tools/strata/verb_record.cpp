// SPDX-License-Identifier: Apache-2.0
/// `strata record --out BAG`: records topics into a rosbag2 bag until Ctrl-C.
#include <memory>
#include <string>
#include <vector>

#include "components/runtime/host.hpp"
#include "tools/strata/all_components.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct RecordOptions {
  std::string out;
  std::vector<std::string> topics;
  std::string storage = "sqlite3";
  std::string transport = "default";
  int domain = 0;
};

void record(const RecordOptions& options, VerbContext& context) {
  refuse_config(context.options, "use the options of `strata record --help`");
  if (!context.options.overrides.empty()) {
    throw ConfigError("--set " + context.options.overrides.front(), "does not apply to this verb",
                      "use the options of `strata record --help`");
  }
  runtime::Composition composition;
  composition.place = "command line";
  composition.domain = options.domain;
  composition.transport = bus::transport_from_name(options.transport);
  runtime::ComponentEntry entry;
  entry.type = "strata::Recorder";
  entry.name = "recorder";
  entry.node_namespace = "/";
  entry.parameters["out"] = options.out;
  entry.parameters["storage"] = options.storage;
  for (const std::string& topic : options.topics) entry.parameters["topics"].push_back(topic);
  composition.processes = {{"record", runtime::ExecutorKind::kSingleThreaded, {entry}}};

  const runtime::Registry registry = all_components();
  runtime::Host host(composition, composition.processes[0], registry,
                     runtime::make_participant(composition), {});
  host.activate();
  context.note("recording into " + options.out + "; Ctrl-C ends it");
  while (!context.interrupt().wait_for(0.1)) {
    host.tick();
    if (const auto errors = host.take_errors(); !errors.empty()) {
      throw OutputError(options.out, errors.front(), "free some space and record again");
    }
  }
  host.stop();
}

}  // namespace

void add_record(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* verb = add_verb(app, context, "record", "Record topics into a rosbag2 bag until Ctrl-C",
                            "strata record --out bag --topics /scan /odom",
                            [options, &context] { record(*options, context); });
  verb->add_option("--out", options->out, "bag folder to write")->required();
  verb->add_option("--topics", options->topics, "topics; all when left out");
  verb->add_option("--storage", options->storage, "sqlite3 or mcap");
  verb->add_option("--domain", options->domain, "ROS_DOMAIN_ID")->envname("ROS_DOMAIN_ID");
  verb->add_option("--transport", options->transport, "default, loopback or shared_memory");
}

}  // namespace strata::tools
