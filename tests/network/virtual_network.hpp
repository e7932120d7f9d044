// SPDX-License-Identifier: Apache-2.0
/// Several hosts on this machine, each with a network and a shared memory of its own.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "tests/network/lossy_hub.hpp"
#include "tests/support/child_process.hpp"

namespace strata::test {

/// Host i, from 0 on, has the address 10.77.0.<i + 1>, and sees the others through a hub.
class VirtualNetwork {
 public:
  /// Throws OutputError where the system does not allow it: needs root, TAP devices, `ip`,
  /// `unshare` and `nsenter`.
  explicit VirtualNetwork(std::size_t hosts);

  [[nodiscard]] static std::string address(std::size_t host);
  /// Runs a command on a host; its lines on stderr are read too.
  [[nodiscard]] std::unique_ptr<ChildProcess> run(std::size_t host,
                                                  const std::vector<std::string>& command,
                                                  std::vector<std::string> environment = {}) const;
  [[nodiscard]] LossyHub& hub() { return *hub_; }

 private:
  std::vector<std::unique_ptr<ChildProcess>> holders_;  // keep the hosts' namespaces
  std::unique_ptr<LossyHub> hub_;
};

}  // namespace strata::test
