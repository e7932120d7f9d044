// SPDX-License-Identifier: Apache-2.0
/// Reference tables of config structs, made from `describe`, so that pages cannot drift.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "components/settings/config_reader.hpp"
#include "components/settings/config_writer.hpp"
#include "core/base/config.hpp"

namespace strata::settings {

/// One row of a reference table.
struct ReferenceRow {
  std::string key;  ///< dotted path; the items of a list are "list[].key"
  std::string type;
  std::string default_value;  ///< as YAML; empty for groups
  std::string unit;
  std::string range;  ///< "0 to 1", "at least 0", or empty
  std::string doc;
};

/// Every key of a config struct with what it says of itself, groups and lists included.
template <typename Config>
[[nodiscard]] std::vector<ReferenceRow> reference_rows();

/// The same as a Markdown table with the columns key, type, default, unit, range, meaning.
template <typename Config>
[[nodiscard]] std::string reference_markdown();

namespace detail {

[[nodiscard]] std::string range_text(const FieldInfo& info);
[[nodiscard]] std::string markdown_table(const std::vector<ReferenceRow>& rows);

template <typename T>
[[nodiscard]] std::string type_text() {
  if constexpr (std::is_same_v<T, bool>) {
    return "true or false";
  } else if constexpr (std::is_enum_v<T>) {
    std::string text;
    for (const auto& [value, name] : EnumNames<T>::values) {
      text += (text.empty() ? "`" : ", `") + std::string(name) + "`";
    }
    return "one of " + text;
  } else if constexpr (std::is_integral_v<T>) {
    return "whole number";
  } else if constexpr (std::is_floating_point_v<T>) {
    return "number";
  } else if constexpr (IsVector<T>::value) {
    return "list of " + type_text<typename T::value_type>() + "s";
  } else {
    return "text";
  }
}

/// The visitor behind reference_rows.
class Describer {
 public:
  Describer(std::vector<ReferenceRow>& rows, std::string path)
      : rows_(rows), path_(std::move(path)) {}

  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& info) {
    rows_.push_back({strata::detail::join_path(path_, name), type_text<T>(), field_text(value),
                     info.unit, range_text(info), info.doc});
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* doc) {
    const std::string path = strata::detail::join_path(path_, name);
    rows_.push_back({path, "group", "", "", "", doc});
    Describer inner(rows_, path);
    Group::describe(group, inner);
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& items, const char* doc) {
    const std::string path = strata::detail::join_path(path_, name);
    rows_.push_back({path, "list", items.empty() ? "[]" : std::to_string(items.size()) + " items",
                     "", "", doc});
    const Item item{};
    Describer inner(rows_, path + "[]");
    Item::describe(item, inner);
  }
  void require(bool, std::string_view, const std::string&, const std::string&) {}

 private:
  std::vector<ReferenceRow>& rows_;
  std::string path_;
};

}  // namespace detail

template <typename Config>
std::vector<ReferenceRow> reference_rows() {
  std::vector<ReferenceRow> rows;
  const Config config{};
  detail::Describer describer(rows, "");
  Config::describe(config, describer);
  return rows;
}

template <typename Config>
std::string reference_markdown() {
  return detail::markdown_table(reference_rows<Config>());
}

}  // namespace strata::settings
