// SPDX-License-Identifier: Apache-2.0
/// Offices drawn at random, so that results do not hang on one floor plan.
#pragma once

#include <cstdint>

#include "tools/simulate/scenario.hpp"

namespace strata::simulate {

struct RandomOfficeOptions {
  int days = 3;
  bool has_change = true;  ///< false: every door and box stays as it is on the first day
  int people = 2;
};

/// A corridor of 16 to 26 m between two rows of rooms 3 to 5.5 m wide; each room has a doorway that
/// is always open or a door, and furniture; one to three boxes stand at one of two places along the
/// corridor. The robot drives the corridor to and fro and into up to two open rooms.
[[nodiscard]] ScenarioConfig random_office(std::uint64_t seed, const RandomOfficeOptions& options);

}  // namespace strata::simulate
