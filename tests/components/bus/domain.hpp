// SPDX-License-Identifier: Apache-2.0
/// Participants for tests: on 127.0.0.1 only, on a domain that other test processes hardly share.
#pragma once

#include <memory>

#include <unistd.h>

#include "components/bus/participant.hpp"

namespace strata::test {

inline int own_domain() { return 10 + static_cast<int>(getpid() % 200); }

inline std::shared_ptr<bus::Participant> make_participant(
    bus::Transport transport = bus::Transport::kLoopback) {
  bus::ParticipantOptions options;
  options.domain = own_domain();
  options.transport = transport;
  return std::make_shared<bus::Participant>(options);
}

}  // namespace strata::test
