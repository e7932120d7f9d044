// SPDX-License-Identifier: Apache-2.0
#include "components/settings/presets.hpp"

#include <algorithm>
#include <set>

#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::settings {
namespace {

void collect(const KeyTree& tree, const std::string& path, std::vector<PresetLine>& lines) {
  for (const KeyTree::Key& key : tree.keys) {
    const std::string full = strata::detail::join_path(path, key.name);
    if (key.is_list) continue;  // a preset says nothing of how many items there are
    if (!key.is_field) {
      collect(key.inside, full, lines);
    } else if (*key.info.preset.preset != '\0') {
      lines.push_back({key.info.preset.preset, full, key.info.preset.value});
    }
  }
}

/// A copy of `map` with `value` at the dotted key, unless there is one already.
YAML::Node with_value(const YAML::Node& map, const std::string& key, const YAML::Node& value,
                      const std::string& place) {
  if (map.IsDefined() && !map.IsNull() && !map.IsMap()) return map;  // the reader complains of it
  const std::size_t dot = key.find('.');
  const std::string first = key.substr(0, dot);
  YAML::Node copy(YAML::NodeType::Map);
  bool is_there = false;
  if (map.IsDefined() && map.IsMap()) {
    for (const auto& item : map) {
      const bool is_it = item.first.IsScalar() && item.first.Scalar() == first;
      is_there = is_there || is_it;
      const bool goes_in = is_it && dot != std::string::npos;
      copy.force_insert(item.first, goes_in
                                        ? with_value(item.second, key.substr(dot + 1), value, place)
                                        : item.second);
    }
    keep_place(copy, map, place);
  } else {
    copy.SetTag(value.Tag());
  }
  if (is_there) return copy;
  YAML::Node name(first);
  name.SetTag(value.Tag());
  copy.force_insert(name, dot == std::string::npos
                              ? value
                              : with_value(YAML::Node(), key.substr(dot + 1), value, place));
  return copy;
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// The presets that a document names.
std::vector<std::string> named(const YAML::Node& given, const std::string& place,
                               const std::vector<std::string>& known) {
  std::vector<std::string> names;
  const auto take = [&](const YAML::Node& node) {
    const std::string name = node.IsScalar() ? node.Scalar() : "";
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw ConfigError(place_of(node, place, kPresetKey),
                        "preset " + (node.IsScalar() ? "'" + name + "'" : "that is no name") +
                            " sets nothing here",
                        "known presets are: " + listed(known));
    }
    names.push_back(name);
  };
  if (!given.IsSequence()) {
    take(given);
  } else {
    for (const auto& item : given) take(item);
  }
  return names;
}

}  // namespace

std::vector<PresetLine> preset_lines(const KeyTree& tree) {
  std::vector<PresetLine> lines;
  collect(tree, "", lines);
  return lines;
}

std::vector<std::string> preset_names(const KeyTree& tree) {
  std::set<std::string> names;
  for (const PresetLine& line : preset_lines(tree)) names.insert(line.preset);
  return {names.begin(), names.end()};
}

YAML::Node with_presets(const YAML::Node& document, const std::string& place, const KeyTree& tree) {
  if (!document.IsMap() || !document[kPresetKey].IsDefined()) return document;
  const std::vector<std::string> known = preset_names(tree);
  if (known.empty()) return document;
  const YAML::Node node = copy_apart(document, place);
  const YAML::Node given = node[kPresetKey];
  YAML::Node result(YAML::NodeType::Map);
  int times = 0;
  for (const auto& item : node) {
    if (item.first.IsScalar() && item.first.Scalar() == kPresetKey) {
      ++times;
    } else {
      result.force_insert(item.first, item.second);
    }
  }
  if (times > 1) {
    throw ConfigError(place_of(given, place, kPresetKey), "preset is given twice",
                      "write a list: preset: [NAME, NAME]");
  }
  keep_place(result, node, place);
  for (const std::string& name : named(given, place, known)) {
    for (const PresetLine& line : preset_lines(tree)) {
      if (line.preset != name) continue;
      YAML::Node value = YAML::Load(line.value);
      YAML::Node placed(value.Scalar());
      keep_place(placed, given, place);
      result.reset(with_value(result, line.key, placed, place));
    }
  }
  return result;
}

}  // namespace strata::settings
