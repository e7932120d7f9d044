// SPDX-License-Identifier: Apache-2.0
#include "tools/shards/shard.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "core/base/error.hpp"

namespace strata::shards {

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool has_bar = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = has_bar ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  if (!has_bar || count.ec != std::errc() || count.ptr != end) {
    throw InputError("--shard " + text, "is not of the form I/N", "write 3/8 for the third of 8");
  }
  if (shard.count < 1 || shard.count > kMaxShards || shard.index < 1 || shard.index > shard.count) {
    throw InputError("--shard " + text, "names no shard",
                     "count from 1 to N, at most " + std::to_string(kMaxShards));
  }
  return shard;
}

std::string label(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

std::vector<int> owners(std::span<const double> weights, int shards) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<int> owner;
  double before = 0.0;
  for (const double weight : weights) {
    const double middle = (before + 0.5 * weight) / total;
    owner.push_back(std::clamp(1 + static_cast<int>(middle * shards), 1, shards));
    before += weight;
  }
  return owner;
}

}  // namespace strata::shards
