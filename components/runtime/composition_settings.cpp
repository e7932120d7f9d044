// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition_settings.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "components/bus/names.hpp"
#include "components/runtime/node_pattern.hpp"
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
      // A copy: the same entry may go to several components, and what is merged later to one.
      into.force_insert(item.first, settings::copy_with_places(item.second, ""));
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

/// An entry of a ROS 2 parameter file.
struct RosEntry {
  NodePattern nodes;
  YAML::Node parameters;
  std::string place;
};

/// Namespaces may be nested groups: "robot1: {localizer: {ros__parameters: ...}}". place: of
/// `path`.
void collect_ros_entries(const YAML::Node& node, const std::string& path, const std::string& place,
                         std::vector<RosEntry>& entries) {
  if (!node.IsMap()) return;
  for (const auto& item : node) {
    const std::string& key = item.first.Scalar();
    if (key != kRosParameters) {
      collect_ros_entries(item.second, path.empty() ? key : path + "/" + key,
                          settings::place_of(item.first, place, path), entries);
    } else if (path.empty()) {
      // As ROS 2's own reader of these files.
      throw ConfigError(settings::place_of(item.first, place, key),
                        std::string(kRosParameters) + " is below no node's name",
                        "write the name above it, or /**: for all nodes");
    } else if (item.second.IsMap()) {
      entries.push_back({NodePattern(path), without_dots(item.second), place});
    }
  }
}

/// The entries for one component, the more specific and the later ones later.
std::vector<const RosEntry*> entries_for(const Place& component,
                                         const std::vector<RosEntry>& entries) {
  std::vector<std::pair<NodePattern::Specificity, const RosEntry*>> found;
  for (const RosEntry& entry : entries) {
    if (const auto match = entry.nodes.match(component.full_name)) {
      found.emplace_back(*match, &entry);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const RosEntry*> sorted;
  for (const auto& [specificity, entry] : found) sorted.push_back(entry);
  return sorted;
}

/// components: those that no entry names.
void refuse_typo(const RosEntry& entry, const std::vector<Place>& components) {
  for (const Place& component : components) {
    if (!entry.nodes.is_typo_of(component.full_name)) continue;
    const std::string& text = entry.nodes.text();
    const bool is_full = text.find('/') != std::string::npos;
    throw ConfigError(entry.place, "the composition has no component '" + text + "'",
                      "did you mean '" + (is_full ? component.full_name : component.name) + "'?");
  }
}

/// What the user is to know of entries that no component takes: in ROS 2 one file serves all nodes
/// of a robot, so they are no errors.
std::vector<std::string> note_of(const std::vector<const RosEntry*>& unused,
                                 const std::string& place) {
  if (unused.empty()) return {};
  std::string names;
  for (const RosEntry* entry : unused) {
    names += (names.empty() ? "" : ", ") + entry->nodes.text();
  }
  return {place + ": for no component of the composition: " + names};
}

std::vector<std::string> apply_ros_entries(YAML::Node& document,
                                           const std::vector<RosEntry>& entries,
                                           const std::string& place) {
  const std::vector<Place> components = component_places(document);
  std::set<const RosEntry*> used;
  std::vector<Place> unnamed;  // a name like that of one that has its own entry is another node's
  for (const Place& component : components) {
    bool is_named = false;
    for (const RosEntry* entry : entries_for(component, entries)) {
      used.insert(entry);
      is_named |= entry->nodes.names_node();
      // What is for every node of a namespace is not known to every one.
      merge_into_component(document, component,
                           entry->nodes.names_node() ? "parameters" : kCommonParameters,
                           entry->parameters);
    }
    if (!is_named) unnamed.push_back(component);
  }
  std::vector<const RosEntry*> unused;
  for (const RosEntry& entry : entries) {
    if (used.contains(&entry)) continue;
    refuse_typo(entry, unnamed);
    unused.push_back(&entry);
  }
  return note_of(unused, place);
}

void apply_own_form(YAML::Node& document, const YAML::Node& given, const std::string& place) {
  for (const auto& item : given) {
    const std::string& key = item.first.Scalar();
    if (!is_composition_key(key)) continue;
    if (look_up(document, key).IsDefined()) document.remove(key);
    document.force_insert(item.first, item.second);
  }
  // Those that the file itself puts there, if it does.
  const std::vector<Place> components = component_places(document);
  for (const auto& item : given) {
    const std::string& key = item.first.Scalar();
    if (is_composition_key(key)) continue;
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
  return {"domain",       "namespace",        "use_sim_time", "transport",
          "static_peers", "discovery_server", "ros_distro",   "enclave",
          "start",        "libraries",        "processes"};
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

std::vector<std::string> apply_composition_settings(YAML::Node& document,
                                                    const std::filesystem::path& file) {
  const std::string place = file.string();
  const YAML::Node text = settings::parse_yaml(read_text(file), place);
  const YAML::Node given = settings::copy_with_places(text, place);
  std::vector<RosEntry> entries;
  collect_ros_entries(given, "", place, entries);
  if (!entries.empty() && !given["version"].IsDefined()) {
    return apply_ros_entries(document, entries, place);
  }
  (void)settings::parse_document(read_text(file), place);  // the version line
  YAML::Node own = given;
  own.remove("version");
  apply_own_form(document, own, place);
  return {};
}

}  // namespace strata::runtime
