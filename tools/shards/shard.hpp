// SPDX-License-Identifier: Apache-2.0
/// One part of a job that is cut into several, each for a process or a machine of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace strata::shards {

/// The index-th of `count` parts, from 1 on. 1/1 is the whole.
struct Shard {
  int index = 1;
  int count = 1;
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// Most shards that a job is cut into.
inline constexpr int kMaxShards = 100'000;

/// "3/8". Throws InputError for what is no such text, and for an index that there is not.
[[nodiscard]] Shard parse_shard(const std::string& text);
[[nodiscard]] std::string label(const Shard& shard);

/// Whose each unit is: runs of neighbours of about equal weight, one a shard, in the order of the
/// shards; one entry a unit, from 1 on. Neighbours stay together, since what they share is then
/// made once. weights: above zero.
[[nodiscard]] std::vector<int> owners(std::span<const double> weights, int shards);

}  // namespace strata::shards
