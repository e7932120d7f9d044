// SPDX-License-Identifier: Apache-2.0
/// One map of a composition file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/settings/config_reader.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {

/// Keys that are known by name only.
inline settings::KeyTree tree_of(const std::vector<std::string>& names) {
  settings::KeyTree tree;
  for (const std::string& name : names) tree.keys.push_back({name, {}, {}, false, true});
  return tree;
}

/// Reads one map with known keys, and says where things are.
class Section {
 public:
  Section(const YAML::Node& node, std::string place, std::string path,
          const std::vector<std::string>& known)
      : node_(node), place_(std::move(place)), path_(std::move(path)) {
    settings::detail::check_keys(node_, settings::detail::ReadContext{place_, {}}, path_,
                                 tree_of(known));
  }

  [[nodiscard]] YAML::Node find(const std::string& key) const { return node_[key]; }
  [[nodiscard]] std::string path_of(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }
  [[nodiscard]] std::string place_of(const std::string& key) const {
    const YAML::Node child = node_[key];
    return settings::place_of(child.IsDefined() ? child : node_, place_, path_of(key));
  }
  template <typename T>
  [[nodiscard]] T get(const std::string& key, T value) const {
    if (const YAML::Node child = node_[key]; child.IsDefined()) {
      settings::detail::read_value(child, place_, path_of(key), value);
    }
    return value;
  }
  [[nodiscard]] std::string require(const std::string& key, const std::string& example) const {
    const auto value = get<std::string>(key, "");
    if (value.empty()) {
      throw ConfigError(settings::place_of(node_, place_, path_), "'" + key + "' is missing",
                        "add " + key + ": " + example);
    }
    return value;
  }
  /// The list below `key`; empty when absent.
  [[nodiscard]] std::vector<YAML::Node> items(const std::string& key) const {
    const YAML::Node child = node_[key];
    if (!child.IsDefined()) return {};
    settings::detail::require_sequence(child, place_, path_of(key));
    return {child.begin(), child.end()};
  }
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> result;
    for (const YAML::Node& item : items(key)) {
      const std::string path = path_of(key) + "[" + std::to_string(result.size()) + "]";
      settings::detail::read_value(item, place_, path, result.emplace_back());
    }
    return result;
  }
  /// Runs `body`; its ConfigError gets the place of `key`.
  template <typename Body>
  auto located(const std::string& key, Body&& body) const {
    try {
      return body();
    } catch (const ConfigError& error) {
      throw ConfigError(place_of(key), error.problem(), error.remedy());
    }
  }

 private:
  const YAML::Node node_;  // const: looking a key up must not make it
  std::string place_;
  std::string path_;
};

/// The value of a key that has one of these names. Throws ConfigError.
template <typename E>
E read_choice(const Section& section, const char* key, const std::string& complaint,
              const char* kind, const std::vector<std::pair<std::string, E>>& choices) {
  const auto given = section.get<std::string>(key, "");
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (given == name) return value;
    names.push_back(name);
  }
  throw ConfigError(section.place_of(key), complaint + " '" + given + "'",
                    settings::detail::suggestion(given, names, kind));
}

}  // namespace strata::runtime
