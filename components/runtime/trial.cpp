// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/trial.hpp"

#include <exception>
#include <filesystem>
#include <set>
#include <utility>

namespace strata::runtime {

Trial::Trial(const ComponentContext& context) : context_(context) {
  // YAML nodes are handles: the component may change what they lead to.
  context_.parameters = YAML::Clone(context.parameters);
  context_.common_parameters = YAML::Clone(context.common_parameters);
  context_.own_folders = std::make_shared<std::set<std::filesystem::path>>(*context.own_folders);
  context_.dry_run = true;
  context_.on_error = nullptr;
}

std::string Trial::failure_with(const YAML::Node& parameters) const {
  if (!context_.make) return {};
  bus::ParticipantOptions options = context_.participant->options();
  options.transport = bus::Transport::kAlone;
  options.security = {};
  const auto mailbox = std::make_shared<Mailbox>();
  std::string failure;
  try {
    ComponentContext other = context_;
    other.participant = std::make_shared<bus::Participant>(options);
    other.mailbox = mailbox;
    other.parameters.reset(YAML::Clone(parameters));
    const std::unique_ptr<Component> component = context_.make(std::move(other));
    try {
      component->configure();
    } catch (const std::exception& error) {
      failure = error.what();
    }
    component->shutdown();
    mailbox->stop();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  return failure;
}

}  // namespace strata::runtime
