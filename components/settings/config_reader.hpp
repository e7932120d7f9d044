// SPDX-License-Identifier: Apache-2.0
/// Reads config structs from YAML by their `describe` (core/base/config.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/settings/yaml_document.hpp"
#include "core/base/config.hpp"

namespace strata::settings {

/// The struct with every key of `node` applied over `start`, read and validated. A list replaces
/// the default list. place: the file name in errors. Throws ConfigError at "PLACE:LINE" for a key
/// that is unknown ("did you mean"), given twice or of the wrong type, and for values that
/// `validate` refuses (every one of them).
template <typename Config>
[[nodiscard]] Config read_config(const YAML::Node& node, const std::string& place,
                                 Config start = {});

namespace detail {

/// Where the reader is, and where every key stood, so that later complaints can name the line.
struct ReadContext {
  std::string place;
  std::map<std::string, std::string> place_of_key;
};

void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                bool& value);
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                int& value);
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::int64_t& value);
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::uint64_t& value);
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                double& value);
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::string& value);
/// The place of the node's text in `names`; throws when it is none of them.
[[nodiscard]] std::size_t read_choice(const YAML::Node& node, const std::string& place,
                                      const std::string& path,
                                      const std::vector<std::string>& names);
/// Letters to add, remove, replace or swap with their neighbour to make `b` of `a`. O(a b).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);
/// "did you mean 'X'?" when one of the names is near, else the list of names; kind: "keys".
[[nodiscard]] std::string suggestion(const std::string& text, const std::vector<std::string>& names,
                                     const std::string& kind);
void require_sequence(const YAML::Node& node, const std::string& place, const std::string& path);
/// Throws unless the node is a map whose keys are plain, different and in `known`.
void check_keys(const YAML::Node& node, const ReadContext& context, const std::string& path,
                const std::vector<std::string>& known);
[[noreturn]] void throw_problems_with_places(const Problems& problems, const ReadContext& context);

template <typename T>
struct IsVector : std::false_type {};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type {};

/// Collects the keys of one struct, not those of its groups.
class KeyCollector {
 public:
  template <typename T>
  void field(std::string_view name, const T& /*value*/, const FieldInfo& /*info*/) {
    names_.emplace_back(name);
  }
  template <typename Group>
  void group(std::string_view name, const Group& /*group*/, const char* /*doc*/) {
    names_.emplace_back(name);
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& /*items*/, const char* /*doc*/) {
    names_.emplace_back(name);
  }
  void require(bool, std::string_view, const std::string&, const std::string&) {}
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
};

template <typename Config>
void read_into(const YAML::Node& node, ReadContext& context, const std::string& path,
               Config& config);

/// The visitor that fills one struct from one map.
class Reader {
 public:
  Reader(const YAML::Node& node, ReadContext& context, std::string path)
      : node_(node), context_(context), path_(std::move(path)) {}

  template <typename T>
  void field(std::string_view name, T& value, const FieldInfo& /*info*/) {
    const YAML::Node child = find(name);
    if (!child.IsDefined()) return;
    const std::string path = strata::detail::join_path(path_, name);
    if constexpr (IsVector<T>::value) {
      require_sequence(child, context_.place, path);
      value.clear();
      for (std::size_t i = 0; i < child.size(); ++i) {
        typename T::value_type item{};
        read_value(child[i], context_.place, path + "[" + std::to_string(i) + "]", item);
        value.push_back(std::move(item));
      }
    } else if constexpr (std::is_enum_v<T>) {
      std::vector<std::string> names;
      for (const auto& [candidate, text] : EnumNames<T>::values) names.emplace_back(text);
      value = EnumNames<T>::values[read_choice(child, context_.place, path, names)].first;
    } else {
      read_value(child, context_.place, path, value);
    }
  }
  template <typename Group>
  void group(std::string_view name, Group& group, const char* /*doc*/) {
    const YAML::Node child = find(name);
    if (!child.IsDefined()) return;
    read_into(child, context_, strata::detail::join_path(path_, name), group);
  }
  template <typename Item>
  void list(std::string_view name, std::vector<Item>& items, const char* /*doc*/) {
    const YAML::Node child = find(name);
    if (!child.IsDefined()) return;
    const std::string path = strata::detail::join_path(path_, name);
    require_sequence(child, context_.place, path);
    items.clear();
    for (std::size_t i = 0; i < child.size(); ++i) {
      Item item{};
      read_into(child[i], context_, path + "[" + std::to_string(i) + "]", item);
      items.push_back(std::move(item));
    }
  }
  // Requirements hold for whole structs only; read_config validates at the end.
  void require(bool, std::string_view, const std::string&, const std::string&) {}

 private:
  [[nodiscard]] YAML::Node find(std::string_view name) {
    YAML::Node child = node_[std::string(name)];
    if (child.IsDefined()) {
      const std::string path = strata::detail::join_path(path_, name);
      context_.place_of_key[path] = place_of(child, context_.place, path);
    }
    return child;
  }
  const YAML::Node node_;  // const: looking a key up must not make it
  ReadContext& context_;
  std::string path_;
};

template <typename Config>
void read_into(const YAML::Node& node, ReadContext& context, const std::string& path,
               Config& config) {
  KeyCollector keys;
  Config::describe(config, keys);
  check_keys(node, context, path, keys.names());
  if (node.IsNull()) return;
  context.place_of_key[path] = place_of(node, context.place, path);
  Reader reader(node, context, path);
  Config::describe(config, reader);
}

}  // namespace detail

template <typename Config>
Config read_config(const YAML::Node& node, const std::string& place, Config start) {
  detail::ReadContext context{place, {}};
  detail::read_into(node, context, "", start);
  if (const Problems problems = validate(start); !problems.empty()) {
    detail::throw_problems_with_places(problems, context);
  }
  return start;
}

}  // namespace strata::settings
