// SPDX-License-Identifier: Apache-2.0
/// One message of each type that Strata reads or writes, with every field set: strings of several
/// lengths, empty and nested sequences, so that each alignment occurs.
#pragma once

#include "components/bus/message_types.hpp"

namespace strata::test {

template <typename T>
[[nodiscard]] T sample();

/// A map of so many cells along each side; 2000 make 4 MB.
[[nodiscard]] nav_msgs::msg::OccupancyGrid square_map(std::uint32_t side);

}  // namespace strata::test
