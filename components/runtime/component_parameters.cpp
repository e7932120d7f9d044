// SPDX-License-Identifier: Apache-2.0
/// The part of a component in which others change its parameters. What waits for the next configure
/// is tried out first, on a thread of its own: the component works on meanwhile.
#include <algorithm>
#include <optional>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/trial.hpp"

namespace strata::runtime {

using rcl_interfaces::msg::Parameter;
using rcl_interfaces::msg::SetParametersResult;

namespace {

constexpr const char* kSimTime = "use_sim_time";

bool is_sim_time(const Parameter& parameter) { return parameter.name() == kSimTime; }

SetParametersResult to_message(const ParameterChange& change) {
  SetParametersResult result;
  result.successful(change.ok);
  result.reason(change.reason);
  return result;
}

}  // namespace

/// Changes in turn, each all or none.
struct Component::ParameterRequest {
  std::vector<std::vector<Parameter>> groups;
  std::function<void(const std::vector<SetParametersResult>&)> answer;
  std::vector<SetParametersResult> results;  ///< of the first groups

  [[nodiscard]] const std::vector<Parameter>& group() const { return groups[results.size()]; }
};

void Component::serve_changes() {
  services_->serve_later<bus::srv::SetParameters>(
      full_name_ + "/set_parameters", "parameters", [this](const auto& asked, auto reply) {
        const auto request = std::make_shared<ParameterRequest>();
        for (const Parameter& parameter : asked.parameters())
          request->groups.push_back({parameter});
        request->answer = [reply = std::move(reply)](const auto& results) {
          rcl_interfaces::srv::SetParameters_Response response;
          response.results(results);
          reply(response);
        };
        work_on(request);
      });
  services_->serve_later<bus::srv::SetParametersAtomically>(
      full_name_ + "/set_parameters_atomically", "parameters",
      [this](const auto& asked, auto reply) {
        const auto request = std::make_shared<ParameterRequest>();
        request->groups.push_back(asked.parameters());
        request->answer = [reply = std::move(reply)](const auto& results) {
          rcl_interfaces::srv::SetParametersAtomically_Response response;
          response.result(results.front());
          reply(response);
        };
        work_on(request);
      });
}

void Component::work_on(const std::shared_ptr<ParameterRequest>& request) {
  while (request->results.size() < request->groups.size()) {
    std::vector<Parameter> own = request->group();
    std::erase_if(own, is_sim_time);
    if (!own.empty()) {
      ParameterPlan plan = plan_changes(parameter_model_, own, context_.parameters);
      if (plan.refusal.empty() && !plan.is_live) {
        try_out(request, std::move(plan));
        return;  // it goes on from there
      }
    }
    request->results.push_back(to_message(set_parameters(request->group())));
  }
  request->answer(request->results);
}

void Component::try_out(const std::shared_ptr<ParameterRequest>& request, ParameterPlan plan) {
  if (!trials_) trials_ = std::make_unique<Mailbox>();
  const auto trial = std::make_shared<const Trial>(context_);
  trials_->post([this, request, trial, changed = plan.parameters] {
    const std::string failure = trial->failure_with(changed);
    // A failure that the change does not alter is no reason against it: several parameters can
    // then be mended one by one.
    const bool is_refused = !failure.empty() && failure != trial->failure_before();
    context_.mailbox->post([this, request, failure, is_refused] {
      if (!services_) return;  // off the domain meanwhile
      guarded([&] {
        ParameterChange outcome{false, failure};
        if (!is_refused) {
          outcome = set_parameters(request->group());
          if (outcome.ok && !failure.empty()) {
            outcome.reason = "is set, but configure fails as before: " + failure;
          }
        }
        request->results.push_back(to_message(outcome));
        work_on(request);
      });
    });
  });
}

ParameterChange Component::set_parameters(const std::vector<Parameter>& changes) {
  std::vector<Parameter> own = changes;
  std::optional<bool> use_sim_time;
  const auto clock = std::find_if(own.begin(), own.end(), is_sim_time);
  if (clock != own.end()) {
    if (clock->value().type() != static_cast<std::uint8_t>(ParameterType::kBool)) {
      return {false, std::string(kSimTime) + " is true or false"};
    }
    use_sim_time = clock->value().bool_value();
    std::erase_if(own, is_sim_time);
  }
  ParameterChange outcome{true, ""};
  if (!own.empty()) outcome = change_parameters(parameter_model_, own, context_.parameters);
  if (!outcome.ok) return outcome;
  if (use_sim_time) {
    clock_.use_sim_time(*use_sim_time, resolve("/clock"));
    announce();
  }
  if (!parameter_events_) return outcome;
  rcl_interfaces::msg::ParameterEvent event;
  event.stamp(convert::to_message(now()));
  event.node(full_name_);
  guarded([&] {  // it is set, whoever hears of it
    const ParameterTable table = parameters();
    for (const Parameter& change : changes) {
      const ParameterEntry* set = find_parameter(table, present_name(change.name()));
      if (set == nullptr) continue;
      event.changed_parameters().push_back(parameter(set->descriptor.name(), set->value));
    }
    parameter_events_->publish(event);
  });
  return outcome;
}

}  // namespace strata::runtime
