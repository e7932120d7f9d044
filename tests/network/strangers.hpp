// SPDX-License-Identifier: Apache-2.0
/// Processes of others on a robot's domain: Cyclone DDS as ROS 2 uses it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/network/cyclone_configuration.hpp"
#include "tests/network/network_fixture.hpp"

namespace strata::test {

class Strangers : public Network {
 protected:
  /// The program cyclone_peer on domain 0, with participant index "auto" as ROS 2 sets it.
  [[nodiscard]] std::unique_ptr<ChildProcess> cyclone(
      std::size_t host, const std::vector<std::string>& arguments,
      CycloneNetwork where = CycloneNetwork::kDevices,
      const std::vector<std::string>& devices = {"eth0"}) const;
  /// A ROS 2 process of Cyclone DDS that knows the node `other`.
  [[nodiscard]] std::unique_ptr<ChildProcess> ros_node(
      std::size_t host, const std::string& name, const std::string& other,
      CycloneNetwork where = CycloneNetwork::kDevices) const;
  /// `strata run` of mapping.yaml, up and running.
  [[nodiscard]] std::unique_ptr<ChildProcess> robot(
      std::size_t host, const std::string& transport,
      std::vector<std::string> environment = {}) const;
  /// Two ROS 2 nodes come and go beside it so many times; then it is ended.
  void expect_to_outlive_visits(ChildProcess& robot, int rounds) const;
  /// Ends it as Ctrl-C does; what it said is shown where it does not end well.
  static void expect_good_end(ChildProcess& process);
};

}  // namespace strata::test
