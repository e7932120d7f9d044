// SPDX-License-Identifier: Apache-2.0
/// Kinds of simulated worlds of four days that starts and kidnapped robots are tried in.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

struct WorldKind {
  std::string name;
  std::function<simulate::ScenarioConfig(std::uint64_t seed)> scenario;
};

/// Random offices and floors, with scanners of 4 m and more, floors with boxes that nobody knows,
/// and the decisive door, closed and open. scenarios: the folder of scenario files.
[[nodiscard]] std::vector<WorldKind> kinds_of_worlds(const std::string& scenarios);

}  // namespace strata::experiments
