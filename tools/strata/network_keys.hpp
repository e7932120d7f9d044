// SPDX-License-Identifier: Apache-2.0
/// For verbs that are a composition of one component.
#pragma once

#include <yaml-cpp/yaml.h>

namespace strata::tools {

/// Moves the keys that say where to publish and read, not what, into a document for a composition.
[[nodiscard]] inline YAML::Node take_network_keys(YAML::Node& parameters) {
  YAML::Node document(YAML::NodeType::Map);
  for (const char* key :
       {"domain", "transport", "static_peers", "discovery_server", "ros_distro", "enclave"}) {
    if (!parameters[key].IsDefined()) continue;
    document[key] = parameters[key];
    parameters.remove(key);
  }
  return document;
}

}  // namespace strata::tools
