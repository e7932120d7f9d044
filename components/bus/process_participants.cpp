// SPDX-License-Identifier: Apache-2.0
#include "components/bus/process_participants.hpp"

#include <chrono>

namespace strata::bus {

ProcessParticipants& ProcessParticipants::instance() {
  static auto* participants = new ProcessParticipants;
  return *participants;
}

void ProcessParticipants::add(const std::shared_ptr<Participant::State>& state) {
  const std::lock_guard lock(mutex_);
  states_.push_back(state);
}

void ProcessParticipants::remove(const Guid& guid,
                                 const std::shared_ptr<Participant::State>& state) {
  std::vector<std::shared_ptr<Participant::State>> others;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(states_, [&](const auto& one) { return one.expired() || one.lock() == state; });
    for (const auto& one : states_) {
      if (auto other = one.lock()) others.push_back(std::move(other));
    }
  }
  constexpr std::chrono::seconds kPatience(5);  // the end may have been lost on its way
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (const auto& other : others) other->wait_until_forgotten(guid, deadline);
}

int ProcessParticipants::take_alone_id() {
  constexpr int kFirst = 100;  // behind those that peers look for
  const std::lock_guard lock(mutex_);
  int id = kFirst;
  while (!alone_ids_.insert(id).second) ++id;
  return id;
}

void ProcessParticipants::give_back_alone_id(int id) {
  const std::lock_guard lock(mutex_);
  alone_ids_.erase(id);
}

}  // namespace strata::bus
