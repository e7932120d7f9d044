// SPDX-License-Identifier: Apache-2.0
/// `strata keystore`: who may join a secured domain, and what each may read and write there.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/bus/names.hpp"
#include "components/log/disk.hpp"
#include "components/log/json_text.hpp"
#include "components/security/keystore.hpp"
#include "core/base/error.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/explained_hosts.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

struct KeystoreOptions {
  std::string keystore;
  std::vector<std::string> enclaves;
  std::string composition;
  std::vector<std::string> publish;
  std::vector<std::string> subscribe;
  bool everything = false;
  bool json = false;
};

void add(const KeystoreOptions& options, VerbContext& context) {
  const security::Keystore keystore(options.keystore);
  for (const std::string& enclave : options.enclaves) {
    keystore.add(enclave);
    context.note("added " + enclave +
                 "; it may read and write everything until `strata keystore "
                 "permissions` says what it may");
  }
}

/// Whether a component reads what it finds as it goes.
bool finds_topics(const std::string& type) {
  return type == "strata::Recorder" || type == "strata::IncidentRecorder" ||
         type == "strata::LiveView";
}

/// What the components of a composition read and write, their services included.
security::Permissions permissions_of(const runtime::Composition& composition) {
  security::Permissions permissions;
  const ExplainedHosts explained = explained_hosts(composition);
  for (const bus::DiscoveredEndpoint& endpoint : explained.participant->view().endpoints) {
    auto& topics = endpoint.writes ? permissions.publish : permissions.subscribe;
    topics.push_back(endpoint.wire_topic);
  }
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      if (finds_topics(entry.type)) permissions.subscribe.emplace_back("*");
    }
  }
  for (auto* topics : {&permissions.publish, &permissions.subscribe}) {
    std::sort(topics->begin(), topics->end());
    topics->erase(std::unique(topics->begin(), topics->end()), topics->end());
  }
  return permissions;
}

security::Permissions permissions_of(const KeystoreOptions& options, VerbContext& context) {
  security::Permissions permissions;
  if (options.everything) permissions = security::all_permissions();
  if (!options.composition.empty()) {
    permissions = permissions_of(load_composition(options.composition, context));
  } else {
    refuse_config(context.options, "they belong to --composition");
  }
  const auto wire = [](const std::string& topic) {
    return bus::wire_topic(topic.front() == '/' ? topic : "/" + topic);
  };
  for (const std::string& topic : options.publish) permissions.publish.push_back(wire(topic));
  for (const std::string& topic : options.subscribe) permissions.subscribe.push_back(wire(topic));
  if (permissions.publish.empty() && permissions.subscribe.empty()) {
    throw InputError("command line", "says nothing of what the enclave may do",
                     "give --composition FILE, --publish TOPIC, --subscribe TOPIC or --everything");
  }
  return permissions;
}

void set_permissions(const KeystoreOptions& options, VerbContext& context) {
  const security::Keystore keystore(options.keystore);
  const security::Permissions permissions = permissions_of(options, context);
  for (const std::string& enclave : options.enclaves) {
    keystore.set_permissions(enclave, permissions);
    context.note(enclave + ": may write " + std::to_string(permissions.publish.size()) +
                 " and read " + std::to_string(permissions.subscribe.size()) + " topics");
  }
}

/// What is wrong with an enclave; "" for nothing.
std::string fault_of(const security::Enclave& enclave) {
  try {
    verify(enclave);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

void list(const KeystoreOptions& options) {
  const security::Keystore keystore(options.keystore);
  auto lines = nlohmann::ordered_json::array();
  for (const std::string& name : keystore.enclaves()) {
    const std::string fault = fault_of(security::enclave_in(options.keystore, name));
    if (!options.json) std::cout << name << "  " << (fault.empty() ? "good" : fault) << '\n';
    lines.push_back({{"enclave", name}, {"good", fault.empty()}, {"fault", fault}});
  }
  if (options.json) std::cout << log::json_text(lines);
}

CLI::App* add_action(CLI::App& verb, const std::string& name, const std::string& description,
                     const std::string& example, KeystoreOptions& options) {
  CLI::App* action = verb.add_subcommand(name, description);
  action->add_option("keystore", options.keystore, "its folder")->required();
  action->footer("Example:\n  strata keystore " + name + " " + example);
  action->fallthrough();  // the common options are the verb's
  return action;
}

void add_enclaves(CLI::App& action, KeystoreOptions& options) {
  action.add_option("enclave", options.enclaves, "as /robot1 or /fleet/robot1; one or more")
      ->required();
}

void add_permissions_options(CLI::App& action, KeystoreOptions& options) {
  add_enclaves(action, options);
  action.add_option("--composition", options.composition,
                    "what its components read and write, services included");
  action.add_option("--publish", options.publish, "a topic it may write; * for any text")
      ->take_all()
      ->allow_extra_args(false);
  action.add_option("--subscribe", options.subscribe, "a topic it may read")
      ->take_all()
      ->allow_extra_args(false);
  action.add_flag("--everything", options.everything, "no bounds, as after `add`");
}

}  // namespace

void add_keystore(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<KeystoreOptions>();
  CLI::App* verb = add_verb(
      app, context, "keystore", "certificates and permissions for DDS security, in SROS2's layout",
      "strata keystore create keystore && strata keystore add keystore /robot1 && "
      "strata keystore permissions keystore /robot1 --composition robot.yaml",
      [options, &context, &app] {
        const CLI::App* action = app.get_subcommand("keystore")->get_subcommands().front();
        const std::string& name = action->get_name();
        if (name != "permissions") refuse_config(context.options, "a keystore has no settings");
        if (name == "create") {
          log::remove_left_over(fs::absolute(options->keystore).lexically_normal());
          (void)security::Keystore::create(options->keystore);
          context.note("made " + options->keystore + "; keep its private/ away from robots");
        } else if (name == "add") {
          add(*options, context);
        } else if (name == "permissions") {
          set_permissions(*options, context);
        } else {
          list(*options);
        }
      });
  verb->require_subcommand(1);
  add_action(*verb, "create", "a new keystore with an authority of its own", "keystore", *options);
  add_enclaves(*add_action(*verb, "add", "new enclaves: keys and certificates",
                           "keystore /fleet/robot1 /fleet/robot2", *options),
               *options);
  add_permissions_options(
      *add_action(*verb, "permissions", "say what enclaves may read and write",
                  "keystore /robot1 --composition robot.yaml --subscribe /map", *options),
      *options);
  add_action(*verb, "list", "every enclave and whether it is good", "keystore --json", *options)
      ->add_flag("--json", options->json, "as JSON on stdout");
}

}  // namespace strata::tools
