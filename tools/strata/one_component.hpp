// SPDX-License-Identifier: Apache-2.0
/// For verbs that are a composition of one component.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <yaml-cpp/yaml.h>

#include "components/runtime/composition.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Where to publish and read, as the command line says.
struct NetworkOptions {
  std::optional<int> domain;
  std::string transport;
};
/// Adds --domain and --transport, bound to `network`, which must outlive the app.
void add_network_options(CLI::App& verb, NetworkOptions& network);

/// Puts the parameters that options of the verb say over those that are there.
using SetParameters = std::function<void(YAML::Node& parameters)>;

/// A composition of one component of that type and name, in a process of that name: --config and
/// --set hold its parameters and those of the network; options of the verb win. What nobody says
/// the environment does, as for `strata run`. Tells the user what is to be known of it. Throws
/// ConfigError and InputError.
[[nodiscard]] runtime::Composition compose_one(const std::string& type, const std::string& name,
                                               const std::string& process,
                                               const NetworkOptions& network,
                                               const SetParameters& set, VerbContext& context);

}  // namespace strata::tools
