// SPDX-License-Identifier: Apache-2.0
/// The participants of this process; for the bus's own .cpp files only.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "components/bus/participant_state.hpp"

namespace strata::bus {

/// Lets a participant go only when the others of its process have heard of its end. Fast DDS until
/// 2.14.4 and 3.2 calls readers of the same process by their address: whoever makes or removes an
/// endpoint between a participant's end and the datagram that tells of it calls readers that are
/// freed (https://github.com/eProsima/Fast-DDS/pull/5034). Another thread that does so just while
/// the participant ends is not kept from it. Thread safe.
class ProcessParticipants {
 public:
  /// Never destroyed, since participants may outlive whatever is.
  [[nodiscard]] static ProcessParticipants& instance();
  void add(const std::shared_ptr<Participant::State>& state);
  /// After Fast DDS has removed it. Waits until no other sees it, for 5 s at most.
  void remove(const Guid& guid, const std::shared_ptr<Participant::State>& state);

  /// A number for a participant that nobody sees, until it is given back. Fast DDS itself takes a
  /// new one each time, and after some dozens those that follow are where no peer looks for them.
  [[nodiscard]] int take_alone_id();
  void give_back_alone_id(int id);

 private:
  std::mutex mutex_;
  std::set<int> alone_ids_;                                // under mutex_
  std::vector<std::weak_ptr<Participant::State>> states_;  // under mutex_
};

}  // namespace strata::bus
