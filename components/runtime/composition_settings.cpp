// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition_settings.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "components/runtime/composition_document.hpp"
#include "components/runtime/ros_parameters.hpp"
#include "components/settings/config_reader.hpp"
#include "components/settings/text_file.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

std::vector<std::string> names_of(const std::vector<ComponentPlace>& places) {
  std::vector<std::string> names;
  for (const ComponentPlace& place : places) {
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

void apply_own_form(YAML::Node& document, const YAML::Node& given, const std::string& place) {
  for (const auto& item : given) {
    const std::string& key = item.first.Scalar();
    if (!is_composition_key(key)) continue;
    if (look_up(document, key).IsDefined()) document.remove(key);
    document.force_insert(item.first, item.second);
  }
  // Those that the file itself puts there, if it does.
  const std::vector<ComponentPlace> components = component_places(document);
  for (const auto& item : given) {
    const std::string& key = item.first.Scalar();
    if (is_composition_key(key)) continue;
    bool is_used = false;
    for (const ComponentPlace& component : components) {
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
  settings::require_text_file(file);
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
  const std::vector<ComponentPlace> components = component_places(document);
  bool is_used = false;
  for (const ComponentPlace& component : components) {
    if (component.name != first) continue;
    is_used = true;
    settings::apply_override(document, component.path + ".parameters" + option.substr(end));
  }
  if (is_used) return;
  throw ConfigError("--set " + option, "the composition has no component '" + first + "'",
                    settings::detail::suggestion(first, names_of(components), "components"));
}

std::vector<std::string> apply_composition_settings(YAML::Node& document,
                                                    const std::filesystem::path& file,
                                                    const StandIns& stand_ins) {
  const std::string place = file.string();
  const YAML::Node text = settings::parse_yaml(read_text(file), place);
  const YAML::Node given = settings::copy_with_places(text, place);
  if (has_ros_parameters(given, place) && !text["version"].IsDefined()) {
    return apply_ros_parameters(document, text, place, stand_ins);
  }
  (void)settings::parse_document(read_text(file), place);  // the version line
  YAML::Node own = given;
  own.remove("version");
  apply_own_form(document, own, place);
  return {};
}

}  // namespace strata::runtime
