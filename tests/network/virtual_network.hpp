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

/// Host i, from 0 on, has the address 10.77.<n>.<i + 1> in network n, from 0 on, and sees the
/// others through a hub. Its device there is eth<n>; with no network it has lo only.
class VirtualNetwork {
 public:
  /// Throws OutputError where the system does not allow it: needs root, TAP devices, `ip`,
  /// `unshare` and `nsenter`.
  explicit VirtualNetwork(std::size_t hosts, std::size_t networks = 1);

  [[nodiscard]] static std::string address(std::size_t host, std::size_t network = 0);
  /// Runs a command on a host; its lines on stderr are read too.
  [[nodiscard]] std::unique_ptr<ChildProcess> run(std::size_t host,
                                                  const std::vector<std::string>& command,
                                                  std::vector<std::string> environment = {}) const;
  /// Runs shell words on a host and waits. Throws OutputError when they fail.
  void set_up(std::size_t host, const std::string& words) const;
  /// Of the first network.
  [[nodiscard]] LossyHub& hub() { return *hubs_.front(); }

 private:
  std::vector<std::unique_ptr<ChildProcess>> holders_;  // keep the hosts' namespaces
  std::vector<std::unique_ptr<LossyHub>> hubs_;
};

}  // namespace strata::test
