// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/one_component.hpp"

#include "components/bus/participant.hpp"
#include "tools/strata/verb_config.hpp"

namespace strata::tools {
namespace {

/// Moves the keys that say where to publish and read, not what, into a document for a composition.
YAML::Node take_network_keys(YAML::Node& parameters) {
  YAML::Node document(YAML::NodeType::Map);
  for (const char* key :
       {"domain", "transport", "static_peers", "discovery_server", "ros_distro", "enclave"}) {
    if (!parameters[key].IsDefined()) continue;
    document[key] = parameters[key];
    parameters.remove(key);
  }
  return document;
}

}  // namespace

void add_network_options(CLI::App& verb, NetworkOptions& network) {
  verb.add_option("--domain", network.domain, "the environment's ROS_DOMAIN_ID when left out")
      ->check(CLI::Range(0, 232));
  verb.add_option("--transport", network.transport,
                  bus::transport_names() + "; the environment's when left out");
}

runtime::Composition compose_one(const std::string& type, const std::string& name,
                                 const std::string& process, const NetworkOptions& network,
                                 const SetParameters& set, VerbContext& context) {
  YAML::Node parameters = load_config(context.options);
  YAML::Node document = take_network_keys(parameters);
  if (network.domain) document["domain"] = *network.domain;
  if (!network.transport.empty()) document["transport"] = network.transport;
  set(parameters);

  YAML::Node component;
  component["type"] = type;
  component["name"] = name;
  component["parameters"] = parameters;
  YAML::Node only;
  only["name"] = process;
  only["executor"] = "single_threaded";
  only["components"].push_back(component);
  document["processes"].push_back(only);
  runtime::Composition composition =
      runtime::read_composition(document, config_place(context.options));
  for (const std::string& note : composition.notes) context.note("note: " + note);
  return composition;
}

}  // namespace strata::tools
