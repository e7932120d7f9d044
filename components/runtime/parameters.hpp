// SPDX-License-Identifier: Apache-2.0
/// A component's config struct as ROS 2 parameters: flat dotted names, typed values, descriptors.
/// Lists of structs have no place among them and are left out.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "strata_idl/rcl_interfaces.h"
#include <yaml-cpp/yaml.h>

#include "components/settings/config_reader.hpp"
#include "core/base/config.hpp"

namespace strata::runtime {

/// The numbers of rcl_interfaces/ParameterType.
enum class ParameterType : std::uint8_t {
  kNotSet = 0,
  kBool = 1,
  kInteger = 2,
  kDouble = 3,
  kString = 4,
  kIntegers = 7,
  kDoubles = 8,
  kStrings = 9
};

struct ParameterEntry {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  rcl_interfaces::msg::ParameterValue value;
};
using ParameterTable = std::vector<ParameterEntry>;

[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(bool value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(std::int64_t value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(double value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(const std::string& value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(
    const std::vector<std::int64_t>& value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(const std::vector<double>& value);
[[nodiscard]] rcl_interfaces::msg::ParameterValue parameter_value(
    const std::vector<std::string>& value);

/// What a request to set a parameter holds.
[[nodiscard]] rcl_interfaces::msg::Parameter parameter(const std::string& name,
                                                       rcl_interfaces::msg::ParameterValue value);
/// The value as YAML, as a composition would give it.
[[nodiscard]] YAML::Node to_yaml(const rcl_interfaces::msg::ParameterValue& value);
/// Puts `value` at the dotted name below `root`, making the maps on the way.
void set_in_yaml(YAML::Node& root, const std::string& name, const YAML::Node& value);
[[nodiscard]] const ParameterEntry* find_parameter(const ParameterTable& table,
                                                   std::string_view name);
/// The names that ROS 2's list_parameters gives for these prefixes and depth (0: any).
[[nodiscard]] rcl_interfaces::msg::ListParametersResult list_parameters(
    const ParameterTable& table, const std::vector<std::string>& prefixes, std::uint64_t depth);

namespace detail {

[[nodiscard]] ParameterEntry make_entry(const std::string& name,
                                        rcl_interfaces::msg::ParameterValue value,
                                        const FieldInfo& info, const std::string& constraint);

/// The visitor behind parameter_table.
class ParameterCollector : public strata::detail::VisitorBase {
 public:
  ParameterCollector(ParameterTable& table, std::string path)
      : table_(table), path_(std::move(path)) {}

  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& info) {
    std::string constraint;
    rcl_interfaces::msg::ParameterValue converted;
    if constexpr (std::is_enum_v<T>) {
      for (const auto& [candidate, text] : EnumNames<T>::values) {
        constraint += (constraint.empty() ? "one of " : ", ") + std::string(text);
      }
      converted = parameter_value(std::string(enum_name(value)));
    } else if constexpr (std::is_same_v<T, std::vector<int>>) {
      converted = parameter_value(std::vector<std::int64_t>(value.begin(), value.end()));
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      converted = parameter_value(static_cast<std::int64_t>(value));
    } else {
      converted = parameter_value(value);
    }
    table_.push_back(
        make_entry(strata::detail::join_path(path_, name), std::move(converted), info, constraint));
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* /*doc*/) {
    ParameterCollector inner(table_, strata::detail::join_path(path_, name));
    Group::describe(group, inner);
  }
  template <typename Item>
  void list(std::string_view /*name*/, const std::vector<Item>& /*items*/, const char* /*doc*/) {}

 private:
  ParameterTable& table_;
  std::string path_;
};

}  // namespace detail

/// Every parameter of a config struct, in the order of `describe`.
template <typename Config>
[[nodiscard]] ParameterTable parameter_table(const Config& config) {
  ParameterTable table;
  detail::ParameterCollector collector(table, "");
  Config::describe(config, collector);
  return table;
}

/// A component's parameters, of whichever config struct: what a change is checked against.
struct ParameterModel {
  /// The table of the struct that this YAML gives; throws ConfigError when it is not valid.
  std::function<ParameterTable(const YAML::Node&)> read;
  /// Takes over the parameters that may change while the component is active.
  std::function<void(const YAML::Node&)> apply_live;
  std::vector<std::string> live_names;  ///< changed by apply_live, the rest by configure
  settings::KeyTree keys;               ///< by which old names are found
};

/// Outcome of a change; reason: why not, or when it takes effect.
struct ParameterChange {
  bool ok = false;
  std::string reason;
};

/// What `changes` would make of the parameters.
struct ParameterPlan {
  YAML::Node parameters;
  bool is_live = false;  ///< all of them change while the component is active
  std::string refusal;   ///< why they cannot be made; empty: they can
  std::string note;      ///< of old names that were used; empty: none
};

/// Checks the changes together. Values must have the parameter's type; a whole number may stand for
/// a double. Old names stand for the present ones.
[[nodiscard]] ParameterPlan plan_changes(const ParameterModel& model,
                                         const std::vector<rcl_interfaces::msg::Parameter>& changes,
                                         const YAML::Node& parameters);

/// Makes the changes of a plan without refusal in `parameters` and calls apply_live when every one
/// of them is live.
[[nodiscard]] ParameterChange make_changes(const ParameterModel& model, const ParameterPlan& plan,
                                           YAML::Node& parameters);

/// Both.
[[nodiscard]] ParameterChange change_parameters(
    const ParameterModel& model, const std::vector<rcl_interfaces::msg::Parameter>& changes,
    YAML::Node& parameters);

}  // namespace strata::runtime
