// SPDX-License-Identifier: Apache-2.0
/// The posterior over topologies on its latched topic.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "core/topology/topology_summary.hpp"

namespace strata::convert {

/// visits: stamps of all visits, as many as each topology has labels.
[[nodiscard]] strata_msgs::msg::Topologies to_message(
    std::span<const topology::TopologySummary> topologies, std::span<const Stamp> visits,
    const std::string& frame);
/// Bit for bit what went in. Throws InputError when labels do not fit the visits or the landmarks.
[[nodiscard]] std::vector<topology::TopologySummary> from_message(
    const strata_msgs::msg::Topologies& message);

}  // namespace strata::convert
