// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/restarts.hpp"

#include <algorithm>
#include <cmath>

namespace strata::tools {
namespace {

constexpr double kLongestDelay_s = 60.0;
/// More make no delay longer, but 2 to their power endless.
constexpr int kMaxDoublings = 64;
/// Having run for so long, a process starts with a clean record.
constexpr auto kGoodRun = std::chrono::minutes(1);

}  // namespace

std::optional<std::chrono::duration<double>> Restarts::plan(const runtime::ProcessEntry& process,
                                                            bool failed, Clock::time_point now) {
  const bool again = process.restart == runtime::Restart::kAlways ||
                     (process.restart == runtime::Restart::kOnFailure && failed);
  if (!again) return std::nullopt;
  State& state = states_[process.name];
  if (now - state.started > kGoodRun) state.ends = 0;
  const double delay_s =
      std::min(kLongestDelay_s, process.restart_delay_s * std::pow(2.0, state.ends));
  state.ends = std::min(state.ends + 1, kMaxDoublings);
  const std::chrono::duration<double> delay(delay_s);
  state.due = now + std::chrono::duration_cast<Clock::duration>(delay);
  return delay;
}

void Restarts::started(const std::string& name, Clock::time_point now) {
  states_[name].started = now;
  states_[name].due.reset();
}

bool Restarts::is_due(const std::string& name, Clock::time_point now) const {
  const auto found = states_.find(name);
  return found != states_.end() && found->second.due && *found->second.due <= now;
}

}  // namespace strata::tools
