// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/ros_parameters.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "components/runtime/composition_document.hpp"
#include "components/runtime/composition_settings.hpp"
#include "components/runtime/node_pattern.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

constexpr const char* kRosParameters = "ros__parameters";

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

/// A copy with places in which true and false are spelled as in our files: ROS 2 also takes True,
/// yes and on where they stand without quotes.
YAML::Node spelled_as_ours(const YAML::Node& file, const std::string& place) {
  static const std::map<std::string, const char*> spellings = {
      {"True", "true"},   {"TRUE", "true"},   {"yes", "true"},  {"Yes", "true"},
      {"YES", "true"},    {"on", "true"},     {"On", "true"},   {"ON", "true"},
      {"False", "false"}, {"FALSE", "false"}, {"no", "false"},  {"No", "false"},
      {"NO", "false"},    {"off", "false"},   {"Off", "false"}, {"OFF", "false"}};
  YAML::Node copy = settings::copy_with_places(file, place);
  const std::function<void(const YAML::Node&, YAML::Node)> spell = [&](const YAML::Node& original,
                                                                       YAML::Node copied) {
    if (original.IsMap()) {
      for (const auto& item : original) {
        const std::string& key = item.first.Scalar();
        if (const YAML::Node child = look_up(copied, key); child.IsDefined()) {
          spell(item.second, child);
        }
      }
    } else if (original.IsSequence()) {
      for (std::size_t i = 0; i < original.size(); ++i) spell(original[i], copied[i]);
    } else if (original.IsScalar() && original.Tag() == "?") {
      const auto found = spellings.find(original.Scalar());
      if (found != spellings.end()) copied = std::string(found->second);
    }
  };
  spell(file, copy);
  return copy;
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

/// The entries for one node, the more specific and the later ones later. full_name:
/// "/robot1/matcher".
std::vector<const RosEntry*> entries_for(const std::string& full_name,
                                         const std::vector<RosEntry>& entries) {
  std::vector<std::pair<NodePattern::Specificity, const RosEntry*>> found;
  for (const RosEntry& entry : entries) {
    if (const auto match = entry.nodes.match(full_name)) {
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
void refuse_typo(const RosEntry& entry, const std::vector<ComponentPlace>& components) {
  for (const ComponentPlace& component : components) {
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

/// The full name of the node that a component stands in for.
std::string stood_in_for(const ComponentPlace& component, const StandIn& stand_in) {
  return component.full_name.substr(0, component.full_name.rfind('/') + 1) + stand_in.node;
}

/// Puts an entry's parameters into the component's: those of the node that it stands in for apart,
/// when it has that node's name.
void take_own_entry(YAML::Node& document, const ComponentPlace& component, const RosEntry& entry,
                    const StandIn* stand_in) {
  if (!entry.nodes.names_node()) {  // not every node knows what is for a whole namespace
    merge_into_component(document, component, kCommonParameters, entry.parameters);
    return;
  }
  YAML::Node own(YAML::NodeType::Map);
  YAML::Node foreign(YAML::NodeType::Map);
  for (const auto& item : entry.parameters) {
    const bool is_foreign = stand_in != nullptr && component.name == stand_in->node &&
                            has_parameter(*stand_in, item.first.Scalar());
    (is_foreign ? foreign : own).force_insert(item.first, item.second);
  }
  merge_into_component(document, component, "parameters", own);
  if (foreign.size() > 0) merge_into_component(document, component, kStandInParameters, foreign);
}

/// What only the node's name is for, of another name than the component's. Returns a note when
/// several components could take it.
std::string take_stand_in_entries(YAML::Node& document, const ComponentPlace& component,
                                  const std::vector<ComponentPlace>& components,
                                  const StandIn& stand_in, const std::vector<RosEntry>& entries,
                                  std::set<const RosEntry*>& used) {
  const std::string node = stood_in_for(component, stand_in);
  const auto takes_it = [&](const ComponentPlace& other) {
    return other.full_name == node ||
           (other.type == component.type && stood_in_for(other, stand_in) == node);
  };
  const bool is_alone = std::count_if(components.begin(), components.end(), takes_it) == 1;
  std::string note;
  for (const RosEntry* entry : entries_for(node, entries)) {
    if (!entry->nodes.names_node() || component.full_name == node) continue;
    used.insert(entry);
    if (is_alone) {
      merge_into_component(document, component, kStandInParameters, entry->parameters);
    } else {
      note = entry->place + ": " + entry->nodes.text() + " is for none of several that could be " +
             node + "; name one of them " + stand_in.node + ", or write their own names";
    }
  }
  return note;
}

}  // namespace

bool has_ros_parameters(const YAML::Node& file, const std::string& place) {
  std::vector<RosEntry> entries;
  collect_ros_entries(file, "", place, entries);
  return !entries.empty();
}

std::vector<std::string> apply_ros_parameters(YAML::Node& document, const YAML::Node& file,
                                              const std::string& place, const StandIns& stand_ins) {
  std::vector<RosEntry> entries;
  collect_ros_entries(spelled_as_ours(file, place), "", place, entries);
  const std::vector<ComponentPlace> components = component_places(document);
  std::set<const RosEntry*> used;
  std::set<std::string> notes;
  std::vector<ComponentPlace>
      unnamed;  // a name like that of one that has its own entry is another node's
  for (const ComponentPlace& component : components) {
    const StandIn* stand_in = find_stand_in(stand_ins, component.type);
    bool is_named = false;
    for (const RosEntry* entry : entries_for(component.full_name, entries)) {
      used.insert(entry);
      is_named |= entry->nodes.names_node();
      take_own_entry(document, component, *entry, stand_in);
    }
    if (stand_in != nullptr) {
      notes.insert(
          take_stand_in_entries(document, component, components, *stand_in, entries, used));
    }
    if (!is_named) unnamed.push_back(component);
  }
  std::vector<const RosEntry*> unused;
  for (const RosEntry& entry : entries) {
    if (used.contains(&entry)) continue;
    refuse_typo(entry, unnamed);
    unused.push_back(&entry);
  }
  std::vector<std::string> result = note_of(unused, place);
  notes.erase("");
  result.insert(result.end(), notes.begin(), notes.end());
  return result;
}

}  // namespace strata::runtime
