// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition_settings.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "components/bus/names.hpp"
#include "components/settings/config_reader.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

constexpr const char* kRosParameters = "ros__parameters";

/// A component entry of a document that may still be malformed.
struct Place {
  std::string name;
  std::string full_name;  ///< "/robot1/localizer"
  std::string path;       ///< "processes[0].components[2]"
};

std::string text_at(const YAML::Node& node, const char* key, const std::string& otherwise) {
  const YAML::Node child = node[key];
  return child.IsDefined() && child.IsScalar() ? child.Scalar() : otherwise;
}

std::vector<Place> component_places(const YAML::Node& document) {
  std::vector<Place> places;
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
          {name, std::move(full),
           "processes[" + std::to_string(i) + "].components[" + std::to_string(j) + "]"});
    }
  }
  return places;
}

std::vector<std::string> names_of(const std::vector<Place>& places) {
  std::vector<std::string> names;
  for (const Place& place : places) {
    if (std::find(names.begin(), names.end(), place.name) == names.end()) {
      names.push_back(place.name);
    }
  }
  return names;
}

bool is_composition_key(const std::string& key) {
  const std::vector<std::string> keys = composition_keys();
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// What a map has below a key. Asking a Node that is not const would put the key there.
YAML::Node look_up(const YAML::Node& map, const std::string& key) { return map[key]; }

/// Groups are merged key by key; anything else is replaced.
void merge(YAML::Node into, const YAML::Node& from) {
  for (const auto& item : from) {
    const std::string& key = item.first.Scalar();
    const YAML::Node child = look_up(into, key);
    if (item.second.IsMap() && child.IsDefined() && child.IsMap()) {
      merge(child, item.second);
    } else {
      if (child.IsDefined()) into.remove(key);
      into.force_insert(item.first, item.second);
    }
  }
}

/// The group below "a.b" of a map, made when missing.
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

void merge_into_component(YAML::Node& document, const Place& place, const char* group,
                          const YAML::Node& parameters) {
  const std::size_t i = std::stoul(place.path.substr(std::string("processes[").size()));
  const std::size_t j = std::stoul(place.path.substr(place.path.rfind('[') + 1));
  YAML::Node entry = document["processes"][i]["components"][j];
  merge(group_at(entry, group), parameters);
}

/// ROS 2 writes groups with dots: "localizer.particles".
YAML::Node without_dots(const YAML::Node& parameters) {
  YAML::Node result(YAML::NodeType::Map);
  for (const auto& item : parameters) {
    const std::string& key = item.first.Scalar();
    const std::size_t dot = key.rfind('.');
    YAML::Node group = dot == std::string::npos ? result : group_at(result, key.substr(0, dot));
    const YAML::Node value = item.second.IsMap() ? without_dots(item.second) : item.second;
    YAML::Node one(YAML::NodeType::Map);
    YAML::Node name(key.substr(dot == std::string::npos ? 0 : dot + 1));
    name.SetTag(item.first.Tag());
    one.force_insert(name, value);
    merge(group, one);
  }
  return result;
}

/// "/robot1/localizer", "localizer" or "/**" with its parameters.
using RosEntry = std::pair<std::string, YAML::Node>;

/// Namespaces may be nested groups: "robot1: {localizer: {ros__parameters: ...}}".
void collect_ros_entries(const YAML::Node& node, const std::string& path,
                         std::vector<RosEntry>& entries) {
  if (!node.IsMap()) return;
  for (const auto& item : node) {
    const std::string& key = item.first.Scalar();
    if (key == kRosParameters) {
      if (item.second.IsMap()) entries.emplace_back(path, without_dots(item.second));
    } else {
      collect_ros_entries(item.second, path.empty() ? key : path + "/" + key, entries);
    }
  }
}

void apply_ros_entries(YAML::Node& document, const std::vector<RosEntry>& entries,
                       const std::string& place) {
  const std::vector<Place> components = component_places(document);
  enum { kForAll, kByName, kByFullName };
  for (const int round : {kForAll, kByName, kByFullName}) {
    for (const auto& [pattern, parameters] : entries) {
      const bool for_all = pattern == "/**" || pattern == "**";
      if (for_all != (round == kForAll)) continue;
      bool is_used = for_all;
      for (const Place& component : components) {
        if (for_all) {
          merge_into_component(document, component, kCommonParameters, parameters);
          continue;
        }
        const bool full = pattern == component.full_name || "/" + pattern == component.full_name;
        const bool by_name = pattern == component.name || pattern == "/**/" + component.name;
        is_used = is_used || full || by_name;
        if (round == kByFullName ? full : by_name && !full) {
          merge_into_component(document, component, "parameters", parameters);
        }
      }
      if (!is_used) {
        throw ConfigError(
            place, "the composition has no component '" + pattern + "'",
            settings::detail::suggestion(pattern, names_of(components), "components"));
      }
    }
  }
}

void apply_own_form(YAML::Node& document, const YAML::Node& given, const std::string& place) {
  const std::vector<Place> components = component_places(document);
  for (const auto& item : given) {
    const std::string& key = item.first.Scalar();
    if (is_composition_key(key)) {
      if (look_up(document, key).IsDefined()) document.remove(key);
      document.force_insert(item.first, item.second);
      continue;
    }
    bool is_used = false;
    for (const Place& component : components) {
      if (key != component.name && key != component.full_name) continue;
      is_used = true;
      if (item.second.IsMap()) merge_into_component(document, component, "parameters", item.second);
    }
    if (!is_used) {
      std::vector<std::string> known = names_of(components);
      for (const std::string& name : composition_keys()) known.push_back(name);
      throw ConfigError(settings::place_of(item.first, place, key),
                        "'" + key + "' is neither a component nor a key of the composition",
                        settings::detail::suggestion(key, known, "names"));
    }
  }
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    throw InputError(file.string(), "cannot be read", "check that the file exists and is readable");
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::vector<std::string> composition_keys() {
  return {"domain",           "namespace",  "use_sim_time", "transport", "static_peers",
          "discovery_server", "ros_distro", "enclave",      "libraries", "processes"};
}

void apply_composition_override(YAML::Node& document, const std::string& option) {
  const std::size_t end = option.find_first_of(".[=");
  const std::string first = option.substr(0, end);
  if (is_composition_key(first) || end == std::string::npos || option[end] != '.') {
    settings::apply_override(document, option);
    return;
  }
  const std::vector<Place> components = component_places(document);
  bool is_used = false;
  for (const Place& component : components) {
    if (component.name != first) continue;
    is_used = true;
    settings::apply_override(document, component.path + ".parameters" + option.substr(end));
  }
  if (is_used) return;
  throw ConfigError("--set " + option, "the composition has no component '" + first + "'",
                    settings::detail::suggestion(first, names_of(components), "components"));
}

void apply_composition_settings(YAML::Node& document, const std::filesystem::path& file) {
  const std::string place = file.string();
  const YAML::Node text = settings::parse_yaml(read_text(file), place);
  const YAML::Node given = settings::copy_with_places(text, place);
  std::vector<RosEntry> entries;
  collect_ros_entries(given, "", entries);
  if (!entries.empty() && !given["version"].IsDefined()) {
    apply_ros_entries(document, entries, place);
    return;
  }
  (void)settings::parse_document(read_text(file), place);  // the version line
  YAML::Node own = given;
  own.remove("version");
  apply_own_form(document, own, place);
}

}  // namespace strata::runtime
