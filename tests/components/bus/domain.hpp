// SPDX-License-Identifier: Apache-2.0
/// Participants for tests: on 127.0.0.1 only, on a domain that no other test process has.
#pragma once

#include <memory>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include "components/bus/domain_claim.hpp"
#include "components/bus/participant.hpp"

namespace strata::test {

/// The same for the whole process. Below 100, where the ports of DDS are not yet those that the
/// system gives to anybody.
inline int own_domain() {
  static const auto claimed = [] {
    constexpr int kFirst = 10;
    constexpr int kCount = 90;
    for (int i = 0; i < kCount; ++i) {
      const int domain = kFirst + (static_cast<int>(getpid()) + i) % kCount;
      if (auto claim = bus::DomainClaim::take("test", domain)) {
        return std::pair{domain, std::move(*claim)};
      }
    }
    throw std::runtime_error("every domain is taken by a test");
  }();
  return claimed.first;
}

inline std::shared_ptr<bus::Participant> make_participant(
    bus::Transport transport = bus::Transport::kLoopback) {
  bus::ParticipantOptions options;
  options.domain = own_domain();
  options.transport = transport;
  return std::make_shared<bus::Participant>(options);
}

}  // namespace strata::test
