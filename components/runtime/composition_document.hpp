// SPDX-License-Identifier: Apache-2.0
/// Finding and setting the parameters of components in a composition's document.
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace strata::runtime {

/// A component entry of a document that may still be malformed.
struct ComponentPlace {
  std::string type;
  std::string name;
  std::string full_name;  ///< "/robot1/localizer"
  std::string path;       ///< "processes[0].components[2]"
};

/// Those that have a name, in order.
[[nodiscard]] std::vector<ComponentPlace> component_places(const YAML::Node& document);

/// What a map has below a key. Asking a Node that is not const would put the key there.
[[nodiscard]] YAML::Node look_up(const YAML::Node& map, const std::string& key);
/// Groups are merged key by key; anything else is replaced.
void merge(YAML::Node into, const YAML::Node& from);
/// The group below "a.b" of a map, made when missing.
[[nodiscard]] YAML::Node group_at(YAML::Node map, const std::string& path);
/// Merges into a group of a component's entry: "parameters".
void merge_into_component(YAML::Node& document, const ComponentPlace& place, const char* group,
                          const YAML::Node& parameters);

}  // namespace strata::runtime
