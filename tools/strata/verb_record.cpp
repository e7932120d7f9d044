// SPDX-License-Identifier: Apache-2.0
/// `strata record --out BAG`: records topics into a rosbag2 bag until Ctrl-C.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/runtime/host.hpp"
#include "components/settings/config_reader.hpp"
#include "tools/strata/all_components.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct RecordOptions {
  std::string out;
  std::vector<std::string> topics;
  std::string storage;
  std::optional<double> split_mb;
  std::optional<double> split_s;
  std::string transport;
  std::optional<int> domain;
};

/// A key of the settings that is not the recorder's own.
std::string take(YAML::Node& document, const char* key, const std::string& otherwise) {
  if (!document[key].IsDefined()) return otherwise;
  const auto value = document[key].as<std::string>();
  document.remove(key);
  return value;
}

/// A composition of one recorder: --config and --set hold its parameters, `domain` and `transport`;
/// options of their own win.
runtime::Composition composition_of(const RecordOptions& options, const CommonOptions& common) {
  YAML::Node document = load_config(common);
  const std::string domain = take(document, "domain", "0");
  const std::string transport = take(document, "transport", "default");
  document["out"] = options.out;
  if (!options.storage.empty()) document["storage"] = options.storage;
  if (options.split_mb) document["split_mb"] = *options.split_mb;
  if (options.split_s) document["split_s"] = *options.split_s;
  if (!options.topics.empty()) document["topics"] = options.topics;

  runtime::Composition composition;
  composition.place = config_place(common);
  if (options.domain) {
    composition.domain = *options.domain;
  } else {
    settings::detail::read_value(YAML::Node(domain), composition.place, "domain",
                                 composition.domain);
  }
  composition.transport =
      bus::transport_from_name(options.transport.empty() ? transport : options.transport);
  runtime::ComponentEntry entry;
  entry.type = "strata::Recorder";
  entry.name = "recorder";
  entry.node_namespace = "/";
  entry.parameters = document;
  composition.processes = {{"record", runtime::ExecutorKind::kSingleThreaded, {entry}}};
  return composition;
}

void record(const RecordOptions& options, VerbContext& context) {
  const runtime::Composition composition = composition_of(options, context.options);
  const runtime::Registry registry = all_components();
  runtime::Host host(composition, composition.processes[0], registry,
                     runtime::make_participant(composition), {});
  host.activate();
  context.interrupt().set_grace(std::chrono::duration<double>(kStopPatience).count());
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
  CLI::App* verb = add_verb(app, context, "record", "record topics into a rosbag2 bag until Ctrl-C",
                            "strata record --out bag --topics /scan /odom",
                            [options, &context] { record(*options, context); });
  verb->add_option("--out", options->out, "bag folder to write")->required();
  verb->add_option("--topics", options->topics, "topics; all when left out");
  verb->add_option("--storage", options->storage, "sqlite3 or mcap");
  verb->add_option("--split-mb", options->split_mb, "begin another file when one holds this much");
  verb->add_option("--split-s", options->split_s, "... or spans this many seconds");
  verb->add_option("--domain", options->domain, "ROS_DOMAIN_ID")->envname("ROS_DOMAIN_ID");
  verb->add_option("--transport", options->transport, "default, loopback or shared_memory");
}

}  // namespace strata::tools
