// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition_document.hpp"

#include <algorithm>
#include <utility>

#include "components/settings/yaml_document.hpp"

namespace strata::runtime {
namespace {

std::string text_at(const YAML::Node& node, const char* key, const std::string& otherwise) {
  const YAML::Node child = node[key];
  return child.IsDefined() && child.IsScalar() ? child.Scalar() : otherwise;
}

}  // namespace

std::vector<ComponentPlace> component_places(const YAML::Node& document) {
  std::vector<ComponentPlace> places;
  const std::string scope = text_at(document, "namespace", "/");
  const YAML::Node processes = document["processes"];
  if (!processes.IsDefined() || !processes.IsSequence()) return places;
  for (std::size_t i = 0; i < processes.size(); ++i) {
    if (!processes[i].IsMap()) continue;
    const YAML::Node process = processes[i];
    const YAML::Node components = process["components"];
    if (!components.IsDefined() || !components.IsSequence()) continue;
    for (std::size_t j = 0; j < components.size(); ++j) {
      if (!components[j].IsMap()) continue;
      const YAML::Node component = components[j];
      const std::string name = text_at(component, "name", "");
      if (name.empty()) continue;
      std::string full = text_at(component, "namespace", scope);
      if (full.empty() || full.front() != '/') full = "/" + full;
      full += full.back() == '/' ? name : "/" + name;
      places.push_back(
          {text_at(component, "type", ""), name, std::move(full),
           "processes[" + std::to_string(i) + "].components[" + std::to_string(j) + "]"});
    }
  }
  return places;
}

YAML::Node look_up(const YAML::Node& map, const std::string& key) { return map[key]; }

void merge(YAML::Node into, const YAML::Node& from) {
  for (const auto& item : from) {
    const std::string& key = item.first.Scalar();
    const YAML::Node child = look_up(into, key);
    if (item.second.IsMap() && child.IsDefined() && child.IsMap()) {
      merge(child, item.second);
    } else {
      if (child.IsDefined()) into.remove(key);
      // A copy: the same entry may go to several components, and what is merged later to one.
      into.force_insert(item.first, settings::copy_with_places(item.second, ""));
    }
  }
}

YAML::Node group_at(YAML::Node map, const std::string& path) {
  std::size_t begin = 0;
  while (begin < path.size()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    const YAML::Node found = look_up(map, key);
    if (!found.IsDefined() || !found.IsMap()) map[key] = YAML::Node(YAML::NodeType::Map);
    const YAML::Node child = map[key];
    map.reset(child);
    begin = end + 1;
  }
  return map;
}

void merge_into_component(YAML::Node& document, const ComponentPlace& place, const char* group,
                          const YAML::Node& parameters) {
  const std::size_t i = std::stoul(place.path.substr(std::string("processes[").size()));
  const std::size_t j = std::stoul(place.path.substr(place.path.rfind('[') + 1));
  YAML::Node entry = document["processes"][i]["components"][j];
  merge(group_at(entry, group), parameters);
}

}  // namespace strata::runtime
