// SPDX-License-Identifier: Apache-2.0
/// What follows the header of OctoMap's files, before OctoMap reads it: its readers take bytes that
/// are not there for nodes, and go on below them without end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace strata::volume {

/// How a node is written: two bits a child; a value, and a byte of children; the same with three
/// bytes of colour after the value.
enum class NodeForm : std::uint8_t { kBinary, kFull, kColor };

/// How many nodes the bytes after "data" hold, the root included; nothing when they end before the
/// last of them or go deeper than a tree of 16 levels. O(nodes).
[[nodiscard]] std::optional<std::size_t> octomap_nodes(std::string_view data, NodeForm form);

}  // namespace strata::volume
