// SPDX-License-Identifier: Apache-2.0
/// strata::FleetMember: a robot's part in a fleet, whenever there is a network.
#pragma once

#include <memory>

#include "components/fleet_member/config.hpp"
#include "components/fleet_member/exchange.hpp"
#include "components/runtime/component.hpp"

namespace strata::fleet_member {

/// Does what `strata fleet push` and `pull` do, again and again while it is active. No topic. In
/// lockstep it rests: a replay has no server.
class FleetMember final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<FleetMemberConfig>(); }
  void on_configure() override { config_ = read_parameters<FleetMemberConfig>(); }
  void on_activate() override;
  void on_deactivate() override;
  void on_tick() override;
  void on_diagnose(runtime::Health& health) const override;

  FleetMemberConfig config_;
  /// One that was stopped stays: whoever deactivates does not wait for its network.
  std::unique_ptr<Exchange> exchange_;
};

}  // namespace strata::fleet_member
