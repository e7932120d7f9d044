// SPDX-License-Identifier: Apache-2.0
/// What follows the header of OctoMap's files, before OctoMap reads it: its readers take bytes that
/// are not there for nodes, and go on below them without end.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace strata::volume {

/// How many nodes the bytes after "data" hold, the root included; nothing when they end before the
/// last of them or go deeper than a tree of 16 levels. is_binary: .bt, two bits a child, else .ot,
/// a value and a byte of children a node. O(nodes).
[[nodiscard]] std::optional<std::size_t> octomap_nodes(std::string_view data, bool is_binary);

}  // namespace strata::volume
