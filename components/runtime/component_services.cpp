// SPDX-License-Identifier: Apache-2.0
/// The part of a component that others manage over DDS: its life and its parameters, by the
/// services that ROS 2 gives every managed node.
#include <algorithm>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/type_description_messages.hpp"
#include "components/runtime/component.hpp"

namespace strata::runtime {
namespace {

using lifecycle_msgs::msg::State;
using lifecycle_msgs::msg::TransitionDescription;

State to_message(LifecycleState state) {
  State message;
  message.id(static_cast<std::uint8_t>(state));
  message.label(lifecycle_label(state));
  return message;
}

TransitionDescription to_message(const LifecycleTransition& transition) {
  TransitionDescription message;
  message.transition().id(transition.id);
  message.transition().label(transition.label);
  message.start_state(to_message(transition.start));
  message.goal_state(to_message(transition.goal));
  return message;
}

/// Every state of lifecycle_msgs.
std::vector<State> all_states() {
  constexpr std::pair<std::uint8_t, const char*> kOthers[] = {{0, "unknown"},
                                                              {15, "errorprocessing"}};
  std::vector<State> states;
  for (const LifecycleState state : kLifecycleStates) states.push_back(to_message(state));
  for (const LifecycleState state : kStatesOnTheWay) states.push_back(to_message(state));
  for (const auto& [id, label] : kOthers) {
    State state;
    state.id(id);
    state.label(label);
    states.push_back(state);
  }
  return states;
}

}  // namespace

void Component::serve() {
  services_ = make_service_hub();
  transition_events_ = std::make_unique<bus::Writer<lifecycle_msgs::msg::TransitionEvent>>(
      context_.participant, resolve("~/transition_event"), bus::qos_profile("default"));
  parameter_events_ = std::make_unique<bus::Writer<rcl_interfaces::msg::ParameterEvent>>(
      context_.participant, resolve("/parameter_events"), bus::qos_profile("parameters"));
  {
    const std::lock_guard lock(bond_mutex_);
    bond_ = std::make_unique<Bond>(context_.participant, resolve("bond"), context_.name);
  }
  serve_lifecycle();
  serve_parameters();
  services_->serve<bus::srv::GetTypeDescription>(
      full_name_ + "/get_type_description", "default",
      [](const auto& request) { return convert::answer(request); });
}

void Component::serve_lifecycle() {
  const auto name = [this](const char* service) { return full_name_ + "/" + service; };
  services_->serve<bus::srv::ChangeState>(
      name("change_state"), "default", [this](const auto& request) {
        lifecycle_msgs::srv::ChangeState_Response response;
        response.success(try_transition(request.transition().id(), request.transition().label()));
        return response;
      });
  services_->serve<bus::srv::GetState>(name("get_state"), "default", [this](const auto&) {
    lifecycle_msgs::srv::GetState_Response response;
    response.current_state(to_message(state_.load()));
    return response;
  });
  services_->serve<bus::srv::GetAvailableStates>(
      name("get_available_states"), "default", [](const auto&) {
        lifecycle_msgs::srv::GetAvailableStates_Response response;
        response.available_states(all_states());
        return response;
      });
  services_->serve<bus::srv::GetAvailableTransitions>(
      name("get_available_transitions"), "default", [this](const auto&) {
        lifecycle_msgs::srv::GetAvailableTransitions_Response response;
        for (const LifecycleTransition& transition : kLifecycleTransitions) {
          if (transition.start != state_) continue;
          response.available_transitions().push_back(to_message(transition));
        }
        return response;
      });
  services_->serve<bus::srv::GetAvailableTransitions>(
      name("get_transition_graph"), "default", [](const auto&) {
        lifecycle_msgs::srv::GetAvailableTransitions_Response response;
        for (const LifecycleTransition& transition : kLifecycleTransitions) {
          response.available_transitions().push_back(to_message(transition));
        }
        return response;
      });
}

bool Component::try_transition(std::uint8_t id, const std::string& label) {
  const LifecycleTransition* transition = find_transition(state_, id, label);
  if (transition == nullptr) return false;
  const std::uint64_t failed_before = failed_;
  guarded([&] { perform(*transition); });
  // A shutdown goes through whatever its hooks throw.
  return failed_ == failed_before || state_ == transition->goal;
}

void Component::tell_transition(const LifecycleTransition& transition) {
  if (!transition_events_) return;
  const TransitionDescription description = to_message(transition);
  lifecycle_msgs::msg::TransitionEvent event;
  event.timestamp(static_cast<std::uint64_t>(now().ns));
  event.transition(description.transition());
  event.start_state(description.start_state());
  event.goal_state(description.goal_state());
  transition_events_->publish(event);
}

void Component::serve_parameters() {
  const auto name = [this](const char* service) { return full_name_ + "/" + service; };
  services_->serve<bus::srv::ListParameters>(
      name("list_parameters"), "parameters", [this](const auto& request) {
        rcl_interfaces::srv::ListParameters_Response response;
        response.result(list_parameters(parameters(), request.prefixes(), request.depth()));
        return response;
      });
  services_->serve<bus::srv::GetParameters>(
      name("get_parameters"), "parameters", [this](const auto& request) {
        rcl_interfaces::srv::GetParameters_Response response;
        const ParameterTable table = parameters();
        for (const std::string& wanted : request.names()) {
          const ParameterEntry* entry = find_parameter(table, present_name(wanted));
          response.values().push_back(entry != nullptr ? entry->value
                                                       : rcl_interfaces::msg::ParameterValue());
        }
        return response;
      });
  services_->serve<bus::srv::GetParameterTypes>(
      name("get_parameter_types"), "parameters", [this](const auto& request) {
        rcl_interfaces::srv::GetParameterTypes_Response response;
        const ParameterTable table = parameters();
        for (const std::string& wanted : request.names()) {
          const ParameterEntry* entry = find_parameter(table, present_name(wanted));
          response.types().push_back(entry != nullptr ? entry->value.type() : 0);
        }
        return response;
      });
  services_->serve<bus::srv::DescribeParameters>(
      name("describe_parameters"), "parameters", [this](const auto& request) {
        rcl_interfaces::srv::DescribeParameters_Response response;
        const ParameterTable table = parameters();
        for (const std::string& wanted : request.names()) {
          rcl_interfaces::msg::ParameterDescriptor descriptor;
          descriptor.name(wanted);
          if (const ParameterEntry* entry = find_parameter(table, present_name(wanted))) {
            descriptor = entry->descriptor;
          }
          response.descriptors().push_back(descriptor);
        }
        return response;
      });
  serve_changes();
}

std::string Component::present_name(const std::string& name) const {
  return settings::present_key(name, parameter_model_.keys);
}

ParameterTable Component::parameters() const {
  ParameterTable table;
  if (parameter_model_.read) table = parameter_model_.read(context_.parameters);
  table.push_back(detail::make_entry("use_sim_time", parameter_value(clock_.uses_sim_time()),
                                     {.doc = "time comes from /clock", .when = "a log is played"},
                                     ""));
  return table;
}

}  // namespace strata::runtime
