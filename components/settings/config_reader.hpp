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

#include "components/settings/key_tree.hpp"
#include "components/settings/old_keys.hpp"
#include "components/settings/presets.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/config.hpp"

namespace strata::settings {

/// The struct with every key of `node` applied over `start`, read and validated. A list replaces
/// the default list. place: the file name in errors. Throws ConfigError at "PLACE:LINE" for a key
/// that is unknown ("did you mean"), given twice or of the wrong type, and for values that
/// `validate` refuses (every one of them). Keys of the version before are read as what they are
/// called now; notes: what to tell the user of them (old_keys.hpp). `preset` sets several at once
/// (presets.hpp).
template <typename Config>
[[nodiscard]] Config read_config(const YAML::Node& node, const std::string& place,
                                 Config start = {}, Notes* notes = nullptr);

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
/// As above for the keys of a struct: of a list those that users touch come first.
[[nodiscard]] std::string key_suggestion(const std::string& text, const KeyTree& known);
/// Throws unless the node is a map whose keys are plain, different and in `known`.
void check_keys(const YAML::Node& node, const ReadContext& context, const std::string& path,
                const KeyTree& known);
[[noreturn]] void throw_problems_with_places(const Problems& problems, const ReadContext& context);

template <typename T>
struct IsVector : std::false_type {};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type {};

template <typename Config>
void read_into(const YAML::Node& node, ReadContext& context, const std::string& path,
               const KeyTree& keys, Config& config);

/// The visitor that fills one struct from one map.
class Reader : public strata::detail::VisitorBase {
 public:
  Reader(const YAML::Node& node, ReadContext& context, std::string path, const KeyTree& keys)
      : node_(node), context_(context), path_(std::move(path)), keys_(keys) {}

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
    read_into(child, context_, strata::detail::join_path(path_, name), keys_.find(name)->inside,
              group);
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
      read_into(child[i], context_, path + "[" + std::to_string(i) + "]", keys_.find(name)->inside,
                item);
      items.push_back(std::move(item));
    }
  }
  // Requirements hold for whole structs only; read_config validates at the end.

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
  const KeyTree& keys_;
};

template <typename Config>
void read_into(const YAML::Node& node, ReadContext& context, const std::string& path,
               const KeyTree& keys, Config& config) {
  check_keys(node, context, path, keys);
  if (node.IsNull()) return;
  context.place_of_key[path] = place_of(node, context.place, path);
  Reader reader(node, context, path, keys);
  Config::describe(config, reader);
}

}  // namespace detail

template <typename Config>
Config read_config(const YAML::Node& node, const std::string& place, Config start, Notes* notes) {
  Notes untold;
  const KeyTree keys = key_tree<Config>();
  const YAML::Node present =
      with_present_keys(node, place, keys, notes == nullptr ? untold : *notes);
  detail::ReadContext context{place, {}};
  detail::read_into(with_presets(present, place, keys), context, "", keys, start);
  if (const Problems problems = validate(start); !problems.empty()) {
    detail::throw_problems_with_places(problems, context);
  }
  return start;
}

}  // namespace strata::settings
