// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/parameters.hpp"

#include <algorithm>
#include <set>

#include "components/settings/config_writer.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {

using rcl_interfaces::msg::ListParametersResult;
using rcl_interfaces::msg::Parameter;
using rcl_interfaces::msg::ParameterDescriptor;
using rcl_interfaces::msg::ParameterValue;

namespace {

ParameterValue of_type(ParameterType type) {
  ParameterValue result;
  result.type(static_cast<std::uint8_t>(type));
  return result;
}

/// A range of ROS 2 has both ends.
bool is_bounded(const FieldInfo& info) {
  return info.min > -std::numeric_limits<double>::infinity() ||
         info.max < std::numeric_limits<double>::infinity();
}

void add_range(const FieldInfo& info, ParameterType type, ParameterDescriptor& descriptor) {
  if (!is_bounded(info)) return;
  if (type == ParameterType::kDouble || type == ParameterType::kDoubles) {
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value(std::max(info.min, std::numeric_limits<double>::lowest()));
    range.to_value(std::min(info.max, std::numeric_limits<double>::max()));
    descriptor.floating_point_range().push_back(range);
  } else if (type == ParameterType::kInteger || type == ParameterType::kIntegers) {
    constexpr double kMax = 9.0e18;
    rcl_interfaces::msg::IntegerRange range;
    range.from_value(static_cast<std::int64_t>(std::max(info.min, -kMax)));
    range.to_value(static_cast<std::int64_t>(std::min(info.max, kMax)));
    descriptor.integer_range().push_back(range);
  }
}

std::size_t separators(std::string_view name) {
  return static_cast<std::size_t>(std::count(name.begin(), name.end(), '.'));
}

bool is_listed(const std::string& name, const std::vector<std::string>& prefixes,
               std::uint64_t depth) {
  if (prefixes.empty()) return depth == 0 || separators(name) < depth;
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
    if (name == prefix) return true;
    if (name.rfind(prefix + ".", 0) != 0) return false;
    return depth == 0 || separators(std::string_view(name).substr(prefix.size() + 1)) < depth;
  });
}

/// The value with the entry's type; throws ConfigError when it has another.
ParameterValue typed(const Parameter& change, const ParameterEntry& entry) {
  const auto wanted = static_cast<ParameterType>(entry.descriptor.type());
  const ParameterValue& value = change.value();
  if (value.type() == entry.descriptor.type()) return value;
  if (wanted == ParameterType::kDouble &&
      value.type() == static_cast<std::uint8_t>(ParameterType::kInteger)) {
    return parameter_value(static_cast<double>(value.integer_value()));
  }
  throw ConfigError(change.name(), "has another type", "see describe_parameters");
}

std::string reason_of(const Error& error) { return error.problem() + "; " + error.remedy(); }

}  // namespace

ParameterValue parameter_value(bool value) {
  ParameterValue result = of_type(ParameterType::kBool);
  result.bool_value(value);
  return result;
}
ParameterValue parameter_value(std::int64_t value) {
  ParameterValue result = of_type(ParameterType::kInteger);
  result.integer_value(value);
  return result;
}
ParameterValue parameter_value(double value) {
  ParameterValue result = of_type(ParameterType::kDouble);
  result.double_value(value);
  return result;
}
ParameterValue parameter_value(const std::string& value) {
  ParameterValue result = of_type(ParameterType::kString);
  result.string_value(value);
  return result;
}
ParameterValue parameter_value(const std::vector<std::int64_t>& value) {
  ParameterValue result = of_type(ParameterType::kIntegers);
  result.integer_array_value(value);
  return result;
}
ParameterValue parameter_value(const std::vector<double>& value) {
  ParameterValue result = of_type(ParameterType::kDoubles);
  result.double_array_value(value);
  return result;
}
ParameterValue parameter_value(const std::vector<std::string>& value) {
  ParameterValue result = of_type(ParameterType::kStrings);
  result.string_array_value(value);
  return result;
}

rcl_interfaces::msg::Parameter parameter(const std::string& name,
                                         rcl_interfaces::msg::ParameterValue value) {
  rcl_interfaces::msg::Parameter parameter;
  parameter.name(name);
  parameter.value(std::move(value));
  return parameter;
}

YAML::Node to_yaml(const ParameterValue& value) {
  using settings::detail::yaml_text;
  YAML::Node list(YAML::NodeType::Sequence);
  switch (static_cast<ParameterType>(value.type())) {
    case ParameterType::kBool:
      return YAML::Node(value.bool_value());
    case ParameterType::kInteger:
      return YAML::Node(value.integer_value());
    case ParameterType::kDouble:
      return YAML::Node(yaml_text(value.double_value()));
    case ParameterType::kString:
      return YAML::Node(value.string_value());
    case ParameterType::kIntegers:
      for (const std::int64_t item : value.integer_array_value()) list.push_back(item);
      break;
    case ParameterType::kDoubles:
      for (const double item : value.double_array_value()) list.push_back(yaml_text(item));
      break;
    case ParameterType::kStrings:
      for (const std::string& item : value.string_array_value()) list.push_back(item);
      break;
    case ParameterType::kNotSet:
      return {};
  }
  return list;
}

void set_in_yaml(YAML::Node& root, const std::string& name, const YAML::Node& value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) {
    root[name] = value;
    return;
  }
  const std::string key = name.substr(0, dot);
  YAML::Node child = root[key];
  if (!child.IsMap()) child = YAML::Node(YAML::NodeType::Map);
  set_in_yaml(child, name.substr(dot + 1), value);
  root[key] = child;
}

const ParameterEntry* find_parameter(const ParameterTable& table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const ParameterEntry& entry) {
    return entry.descriptor.name() == name;
  });
  return found == table.end() ? nullptr : &*found;
}

ListParametersResult list_parameters(const ParameterTable& table,
                                     const std::vector<std::string>& prefixes,
                                     std::uint64_t depth) {
  ListParametersResult result;
  std::set<std::string> scopes;
  for (const ParameterEntry& entry : table) {
    const std::string& name = entry.descriptor.name();
    if (!is_listed(name, prefixes, depth)) continue;
    result.names().push_back(name);
    if (const std::size_t dot = name.rfind('.'); dot != std::string::npos) {
      scopes.insert(name.substr(0, dot));
    }
  }
  result.prefixes().assign(scopes.begin(), scopes.end());
  return result;
}

ParameterEntry detail::make_entry(const std::string& name, ParameterValue value,
                                  const FieldInfo& info, const std::string& constraint) {
  ParameterEntry entry;
  entry.descriptor.name(name);
  entry.descriptor.type(value.type());
  const std::string unit = *info.unit != '\0' ? std::string(" [") + info.unit + "]" : "";
  const std::string tier = *info.when != '\0' ? std::string("; touch it when: ") + info.when
                                              : std::string("; an expert setting");
  entry.descriptor.description(info.doc + unit + tier);
  entry.descriptor.additional_constraints(constraint);
  add_range(info, static_cast<ParameterType>(value.type()), entry.descriptor);
  entry.value = std::move(value);
  return entry;
}

ParameterPlan plan_changes(const ParameterModel& model, const std::vector<Parameter>& changes,
                           const YAML::Node& parameters) {
  if (!model.read) return {{}, false, "the component has not been configured yet", ""};
  ParameterPlan plan{YAML::Clone(parameters), true, "", ""};
  try {
    const ParameterTable table = model.read(parameters);
    for (const Parameter& change : changes) {
      const std::string name = settings::present_key(change.name(), model.keys);
      const ParameterEntry* entry = find_parameter(table, name);
      if (entry == nullptr) return {{}, false, "there is no parameter '" + change.name() + "'", ""};
      if (name != change.name()) plan.note += change.name() + " is called " + name + " now; ";
      set_in_yaml(plan.parameters, name, to_yaml(typed(change, *entry)));
      plan.is_live = plan.is_live && std::find(model.live_names.begin(), model.live_names.end(),
                                               name) != model.live_names.end();
    }
    (void)model.read(plan.parameters);
  } catch (const Error& error) {
    return {{}, false, reason_of(error), ""};
  }
  return plan;
}

ParameterChange make_changes(const ParameterModel& model, const ParameterPlan& plan,
                             YAML::Node& parameters) {
  parameters.reset(plan.parameters);
  if (!plan.is_live) {
    return {true, plan.note + "takes effect when the component is configured again"};
  }
  try {
    model.apply_live(plan.parameters);
  } catch (const Error& error) {
    return {true, plan.note + "is set, but not all of it could be done: " + reason_of(error)};
  }
  return {true, plan.note};
}

ParameterChange change_parameters(const ParameterModel& model,
                                  const std::vector<Parameter>& changes, YAML::Node& parameters) {
  const ParameterPlan plan = plan_changes(model, changes, parameters);
  if (!plan.refusal.empty()) return {false, plan.refusal};
  return make_changes(model, plan, parameters);
}

}  // namespace strata::runtime
