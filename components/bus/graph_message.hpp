// SPDX-License-Identifier: Apache-2.0
/// Nodes to and from the bytes of rmw_dds_common/ParticipantEntitiesInfo in both its layouts.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "components/bus/node.hpp"

namespace strata::bus {

/// gid_bytes: 24 or 16 (gid_bytes_of).
[[nodiscard]] std::vector<std::uint8_t> graph_to_cdr(const Guid& participant,
                                                     const std::vector<NodeInfo>& nodes,
                                                     std::size_t gid_bytes);

/// Whichever layout the bytes have: they must end where the content does. None when neither fits.
[[nodiscard]] std::optional<std::pair<Guid, std::vector<NodeInfo>>> graph_from_cdr(
    const std::vector<std::uint8_t>& bytes);

}  // namespace strata::bus
