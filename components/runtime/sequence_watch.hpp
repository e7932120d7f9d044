// SPDX-License-Identifier: Apache-2.0
/// Messages of a topic that never came, told by the numbers of those that did.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"

namespace strata::runtime {

/// A writer numbers what it writes one by one. What it wrote before its first message came counts
/// as nothing. Remembers the last 64 writers. Not thread safe.
class SequenceWatch {
 public:
  /// A message came; how many of its writer are missing since the one before. O(writers).
  std::uint64_t take(const bus::SampleIdentity& identity);
  /// All that were missing.
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

 private:
  std::vector<std::pair<bus::Guid, std::int64_t>> last_;  ///< the newest writer last
  std::uint64_t missing_ = 0;
};

}  // namespace strata::runtime
