// SPDX-License-Identifier: Apache-2.0
#include "components/fleet_member/fleet_member.hpp"

#include <string>
#include <utility>

namespace strata::fleet_member {
namespace {

void add_age(runtime::Health& health, const std::string& key,
             const std::optional<ExchangeState::Clock::time_point>& time) {
  if (!time) return health.add(key, std::string("never"));
  health.add(key, std::chrono::duration<double>(ExchangeState::Clock::now() - *time).count());
}

}  // namespace

void FleetMember::on_activate() {
  if (lockstep() || context().dry_run) return;
  exchange_ = std::make_unique<Exchange>(config_, "strata::FleetMember " + full_name(),
                                         std::move(exchange_));
}

void FleetMember::on_deactivate() {
  if (exchange_) exchange_->stop();
}

void FleetMember::on_tick() {
  if (exchange_) exchange_->look_after();
}

void FleetMember::on_diagnose(runtime::Health& health) const {
  if (!exchange_) return;
  const ExchangeState found = exchange_->state();
  // The robot drives on without: no error.
  if (!found.trouble.empty()) health.warn(found.trouble);
  if (found.clock && found.clock->is_off()) health.warn(found.clock->warning());
  add_age(health, "last push, s ago", found.pushed);
  add_age(health, "last pull, s ago", found.pulled);
  if (found.clock) health.add("clock ahead of the server, s", found.clock->ahead_s);
  health.add("visits waiting", static_cast<std::uint64_t>(found.waiting));
  health.add("visits sent", found.sent);
  health.add("visits refused", static_cast<std::uint64_t>(found.refused));
  health.add("version pulled", found.version.empty() ? "none" : found.version);
  health.add("failures in a row", found.failures);
  health.add("last error", found.last_error.empty() ? "none" : found.last_error);
}

}  // namespace strata::fleet_member
