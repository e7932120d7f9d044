// SPDX-License-Identifier: Apache-2.0
/// Where the levels of nodes lie that are not in memory.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace strata::memory {

/// Kept by a memory that was opened without its nodes. One thread at a time, together with all
/// memories that share it.
class NodeSource {
 public:
  virtual ~NodeSource() = default;
  /// What TimescaleMemory::node_state gave as `levels`. Throws InputError when it is not there or
  /// damaged.
  [[nodiscard]] virtual std::vector<std::vector<std::byte>> levels_of(std::size_t node) const = 0;
  /// For errors.
  [[nodiscard]] virtual std::string place() const = 0;
};

}  // namespace strata::memory
