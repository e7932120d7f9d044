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
#include "components/settings/presets.hpp"
#include "core/base/config.hpp"

namespace strata::settings {

/// One row of the reference.
struct ReferenceRow {
  std::string key;  ///< dotted path; the items of a list are "list[].key"
  std::string type;
  std::string default_value;  ///< as YAML; empty for groups
  std::string unit;
  std::string range;  ///< "0 to 1", "at least 0", or empty
  std::string doc;
  std::string when;  ///< when a user touches it; empty for an expert setting, a group or a list
};

/// Whether the row belongs to a list: the list itself, or what stands in its items.
[[nodiscard]] bool is_of_list(const ReferenceRow& row);

/// Every key of a config struct with what it says of itself, groups and lists included.
template <typename Config>
[[nodiscard]] std::vector<ReferenceRow> reference_rows();

/// The same as Markdown: the presets, what users set and when to touch it, what is for experts, and
/// the items of lists, below a heading each where there are any.
template <typename Config>
[[nodiscard]] std::string reference_markdown();

namespace detail {

inline constexpr const char* kGroup = "group";
inline constexpr const char* kList = "list";

[[nodiscard]] std::string range_text(const FieldInfo& info);
[[nodiscard]] std::string markdown_of(const std::vector<ReferenceRow>& rows,
                                      const std::vector<PresetLine>& presets);

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
class Describer : public strata::detail::VisitorBase {
 public:
  Describer(std::vector<ReferenceRow>& rows, std::string path)
      : rows_(rows), path_(std::move(path)) {}

  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& info) {
    rows_.push_back({strata::detail::join_path(path_, name), type_text<T>(), field_text(value),
                     info.unit, range_text(info), info.doc, info.when});
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* doc) {
    const std::string path = strata::detail::join_path(path_, name);
    rows_.push_back({path, kGroup, "", "", "", doc, ""});
    Describer inner(rows_, path);
    Group::describe(group, inner);
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& items, const char* doc) {
    const std::string path = strata::detail::join_path(path_, name);
    rows_.push_back({path, kList, items.empty() ? "[]" : std::to_string(items.size()) + " items",
                     "", "", doc, ""});
    const Item item{};
    Describer inner(rows_, path + "[]");
    Item::describe(item, inner);
  }

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
  return detail::markdown_of(reference_rows<Config>(), preset_lines(key_tree<Config>()));
}

}  // namespace strata::settings
