// SPDX-License-Identifier: Apache-2.0
/// A composition file: which components run where, under which names, with which parameters.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/bus/names.hpp"
#include "components/bus/participant.hpp"
#include "components/runtime/executor.hpp"
#include "components/runtime/stand_in.hpp"

namespace strata::runtime {

/// How far `strata run` leads a component by itself; the rest of its life is led by others over
/// DDS, as by nav2's lifecycle manager. A replay leads every component through all of it.
enum class Start { kActive, kInactive, kUnconfigured };

struct ComponentEntry {
  std::string type;  ///< "strata::Localizer"
  std::string name;
  std::string node_namespace;  ///< the composition's unless the entry has its own
  bus::Remappings remappings;
  YAML::Node parameters;
  YAML::Node common_parameters;  ///< for all components: each takes those that it knows
  /// Of the node that the component stands in for, in that node's names; none: none are given.
  YAML::Node stand_in_parameters;
  std::vector<TranslatedParameter> translated;  ///< what became of them
  std::string place;                            ///< "file:line"
  Start start = Start::kActive;                 ///< else the process's, else the composition's
};

/// A shared library with components; see component_library.hpp.
struct LibraryEntry {
  std::string name;
  std::string place;  ///< "file:line"
};

/// What `strata run` does when a process of a composition ends by itself.
enum class Restart {
  kNever,      ///< the others end too
  kOnFailure,  ///< start it again after an exit code other than 0 or a signal
  kAlways,
};

struct ProcessEntry {
  std::string name;
  ExecutorKind executor = ExecutorKind::kMultiThreaded;
  std::vector<ComponentEntry> components;
  Restart restart = Restart::kNever;
  double restart_delay_s = 1.0;  ///< doubled with each failure in a row, to a minute at most
};

struct Composition {
  std::string place;  ///< the file
  std::string node_namespace = "/";
  bool use_sim_time = false;
  bus::ParticipantOptions network;      ///< of every process; security is the environment's
  std::vector<LibraryEntry> libraries;  ///< loaded by load_component_libraries
  std::vector<ProcessEntry> processes;
  std::vector<std::string> notes;  ///< what a user is to know of the settings, one line each
};

/// Throws InputError when the file cannot be read, ConfigError (place: file:line) for an unknown
/// key ("did you mean"), a wrong type, a missing or doubled name, or a transport, executor or name
/// that does not exist. Component types and parameters are checked when they are made.
/// What the file does not say of domain, transport, static_peers, discovery_server and ros_distro
/// the environment does, as ROS 2 reads it (bus/environment.hpp). overrides:
/// "COMPONENT.parameter=value" sets a parameter of the components of that name (as
/// "localizer.maps=MAPS"), "domain=7" a key of the composition. settings_file: see
/// apply_composition_settings; overrides win over it. stand_ins: what is for another project's node
/// there, and a component stands in for that node, becomes the component's parameters, where the
/// composition, the overrides and what is in our names leave them open.
[[nodiscard]] Composition load_composition(const std::filesystem::path& file,
                                           const std::vector<std::string>& overrides = {},
                                           const std::filesystem::path& settings_file = {},
                                           const StandIns& stand_ins = {});
/// Does that last step for a composition that was read; place: of the parameter file. Throws
/// ConfigError.
void translate_stand_ins(Composition& composition, const StandIns& stand_ins,
                         const std::string& place);
/// The same from a document without its version line.
[[nodiscard]] Composition read_composition(const YAML::Node& document, const std::string& place);

}  // namespace strata::runtime
