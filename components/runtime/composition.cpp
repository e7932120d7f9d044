// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition.hpp"

#include <algorithm>
#include <set>

#include "components/bus/environment.hpp"
#include "components/bus/node.hpp"
#include "components/runtime/composition_section.hpp"
#include "components/runtime/composition_settings.hpp"
#include "components/security/enclave.hpp"
#include "components/settings/config_reader.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

bus::Remappings read_remappings(const YAML::Node& node, const std::string& place,
                                const std::string& path) {
  bus::Remappings result;
  if (!node.IsDefined() || node.IsNull()) return result;
  if (!node.IsMap()) {
    throw ConfigError(settings::place_of(node, place, path), path + " is not a map",
                      "write remappings: {scan: /front/scan}");
  }
  for (const auto& rule : node) {
    result[rule.first.as<std::string>()] = rule.second.as<std::string>();
  }
  return result;
}

/// What an entry has unless it says otherwise.
struct Inherited {
  std::string node_namespace;
  Start start = Start::kActive;
};

Start read_start(const Section& section, Start usual) {
  if (!section.find("start").IsDefined()) return usual;
  return read_choice<Start>(section, "start", "a component cannot start", "states",
                            {{"active", Start::kActive},
                             {"inactive", Start::kInactive},
                             {"unconfigured", Start::kUnconfigured}});
}

ComponentEntry read_component(const YAML::Node& node, const std::string& place,
                              const std::string& path, const Inherited& inherited) {
  const Section section(node, place, path,
                        {"type", "name", "namespace", "start", "remappings", "parameters",
                         kCommonParameters, kStandInParameters});
  ComponentEntry entry;
  entry.place = settings::place_of(node, place, path);
  entry.type = section.require("type", "strata::Localizer");
  entry.name = section.require("name", "localizer");
  entry.node_namespace = section.get<std::string>("namespace", inherited.node_namespace);
  entry.start = read_start(section, inherited.start);
  section.located("name",
                  [&] { return bus::expand_name(entry.name, entry.node_namespace, entry.name); });
  entry.remappings =
      read_remappings(section.find("remappings"), place, section.path_of("remappings"));
  entry.common_parameters = YAML::Node(YAML::NodeType::Map);
  if (const YAML::Node common = section.find(kCommonParameters); common.IsDefined()) {
    entry.common_parameters = common;
  }
  entry.stand_in_parameters = YAML::Node(YAML::NodeType::Map);
  if (const YAML::Node given = section.find(kStandInParameters); given.IsDefined()) {
    entry.stand_in_parameters = given;
  }
  const YAML::Node parameters = section.find("parameters");
  // A node that does not exist cannot be assigned to, so it must not get into the entry.
  if (parameters.IsDefined()) {
    entry.parameters = parameters;
  } else {
    entry.parameters = YAML::Node(YAML::NodeType::Map);
  }
  return entry;
}

Restart read_restart(const Section& section) {
  if (!section.find("restart").IsDefined()) return Restart::kNever;
  return read_choice<Restart>(section, "restart", "unknown restart policy", "policies",
                              {{"never", Restart::kNever},
                               {"on_failure", Restart::kOnFailure},
                               {"always", Restart::kAlways}});
}

ProcessEntry read_process(const YAML::Node& node, const std::string& place, const std::string& path,
                          Inherited inherited) {
  const Section section(node, place, path,
                        {"name", "executor", "start", "components", "restart", "restart_delay_s"});
  ProcessEntry entry;
  entry.name = section.require("name", "mapping");
  const auto executor = section.get<std::string>("executor", "multi_threaded");
  if (executor != "multi_threaded" && executor != "single_threaded") {
    throw ConfigError(
        section.place_of("executor"), "unknown executor '" + executor + "'",
        settings::detail::suggestion(executor, {"multi_threaded", "single_threaded"}, "executors"));
  }
  entry.executor =
      executor == "single_threaded" ? ExecutorKind::kSingleThreaded : ExecutorKind::kMultiThreaded;
  entry.restart = read_restart(section);
  entry.restart_delay_s = section.get<double>("restart_delay_s", entry.restart_delay_s);
  if (!(entry.restart_delay_s >= 0.0)) {
    throw ConfigError(section.place_of("restart_delay_s"), "restart_delay_s is negative",
                      "give seconds");
  }
  inherited.start = read_start(section, inherited.start);
  const std::vector<YAML::Node> components = section.items("components");
  for (std::size_t i = 0; i < components.size(); ++i) {
    entry.components.push_back(
        read_component(components[i], place,
                       section.path_of("components") + "[" + std::to_string(i) + "]", inherited));
  }
  return entry;
}

std::vector<LibraryEntry> read_libraries(const Section& section, const std::string& place) {
  std::vector<LibraryEntry> libraries;
  for (const YAML::Node& item : section.items("libraries")) {
    const std::string path = "libraries[" + std::to_string(libraries.size()) + "]";
    LibraryEntry entry;
    entry.place = settings::place_of(item, place, path);
    settings::detail::read_value(item, place, path, entry.name);
    if (entry.name.empty()) throw ConfigError(entry.place, "a library has no name", "name it");
    libraries.push_back(std::move(entry));
  }
  return libraries;
}

/// The transport and whom it asks: what the file says takes the place of the environment's.
void read_discovery(const Section& section, Composition& composition) {
  bus::ParticipantOptions& network = composition.network;
  network.discovery_server = section.get<std::string>("discovery_server", "");
  const bool has_server = !network.discovery_server.empty();
  const bool has_transport = section.find("transport").IsDefined();
  if (has_transport) {
    network.transport = section.located("transport", [&] {
      return bus::transport_from_name(section.get<std::string>("transport", ""));
    });
  } else if (has_server) {
    network.transport = bus::Transport::kDiscoveryServer;
  }
  if (has_transport || has_server) network.is_alone = false;
  const std::string transport(bus::transport_name(network.transport));
  if (has_server && network.transport != bus::Transport::kDiscoveryServer) {
    throw ConfigError(section.place_of("discovery_server"),
                      "a server is not asked with transport: " + transport,
                      "leave transport out, or write transport: discovery_server");
  }
  if (!section.find("static_peers").IsDefined()) return;
  network.static_peers = section.texts("static_peers");
  if (network.static_peers.empty()) return;
  if (!network.is_alone && bus::asks_static_peers(network.transport)) return;
  if (has_transport || has_server) {
    throw ConfigError(section.place_of("static_peers"),
                      "peers are not asked with transport: " + transport,
                      "use transport default, localhost or wifi");
  }
  composition.notes.push_back(
      section.place_of("static_peers") + ": static_peers are not asked: the environment says " +
      (network.is_alone ? "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF" : "transport " + transport) +
      "; name a transport here to have them asked");
}

void require_different_names(const Composition& composition) {
  std::set<std::string> processes;
  std::set<std::string> components;
  for (const ProcessEntry& process : composition.processes) {
    if (!processes.insert(process.name).second) {
      throw ConfigError(composition.place, "two processes are named '" + process.name + "'",
                        "give each its own name");
    }
    for (const ComponentEntry& entry : process.components) {
      if (!components.insert(bus::expand_name(entry.name, entry.node_namespace, entry.name))
               .second) {
        throw ConfigError(entry.place, "a second component is named '" + entry.name + "'",
                          "give each its own name or namespace");
      }
    }
  }
  if (components.empty()) {
    throw ConfigError(composition.place, "no component is listed",
                      "add processes: [{name: main, components: [...]}]");
  }
}

}  // namespace

Composition read_composition(const YAML::Node& document, const std::string& place) {
  const Section section(document, place, "", composition_keys());
  Composition composition;
  composition.place = place;
  const auto release = section.get<std::string>("ros_distro", "");
  if (!release.empty()) section.located("ros_distro", [&] { return bus::gid_bytes_of(release); });
  bus::ParticipantOptions& network = composition.network;
  network = bus::options_from_environment(release);
  network.domain = section.get<int>("domain", network.domain);
  composition.node_namespace = section.get<std::string>("namespace", "/");
  composition.use_sim_time = section.get<bool>("use_sim_time", false);
  read_discovery(section, composition);
  if (!bus::environment_names_enclave()) {
    network.enclave = section.get<std::string>("enclave", "/");
    section.located("enclave", [&] { security::require_enclave_name(network.enclave); });
  }
  composition.libraries = read_libraries(section, place);
  const Inherited inherited{composition.node_namespace, read_start(section, Start::kActive)};
  const std::vector<YAML::Node> processes = section.items("processes");
  for (std::size_t i = 0; i < processes.size(); ++i) {
    composition.processes.push_back(
        read_process(processes[i], place, "processes[" + std::to_string(i) + "]", inherited));
  }
  require_different_names(composition);
  return composition;
}

void translate_stand_ins(Composition& composition, const StandIns& stand_ins,
                         const std::string& place) {
  for (ProcessEntry& process : composition.processes) {
    for (ComponentEntry& entry : process.components) {
      const StandIn* stand_in = find_stand_in(stand_ins, entry.type);
      if (stand_in == nullptr || entry.stand_in_parameters.size() == 0) continue;
      entry.translated = translate(*stand_in, entry.stand_in_parameters, entry.parameters);
      const std::string name = bus::expand_name(entry.name, entry.node_namespace, entry.name);
      for (std::string& note : notes_of(entry.translated, *stand_in, name, place)) {
        composition.notes.push_back(std::move(note));
      }
    }
  }
}

Composition load_composition(const std::filesystem::path& file,
                             const std::vector<std::string>& overrides,
                             const std::filesystem::path& settings_file,
                             const StandIns& stand_ins) {
  YAML::Node document = settings::load_document(file);
  std::vector<std::string> notes;
  if (!settings_file.empty()) {
    notes = apply_composition_settings(document, settings_file, stand_ins);
  }
  for (const std::string& option : overrides) apply_composition_override(document, option);
  Composition composition = read_composition(document, file.string());
  composition.notes.insert(composition.notes.begin(), notes.begin(), notes.end());
  translate_stand_ins(composition, stand_ins, settings_file.string());
  return composition;
}

}  // namespace strata::runtime
