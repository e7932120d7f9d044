// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sequence_watch.hpp"

#include <algorithm>

namespace strata::runtime {
namespace {

constexpr std::size_t kMaxWriters = 64;

}  // namespace

std::uint64_t SequenceWatch::take(const bus::SampleIdentity& identity) {
  if (identity.writer == bus::Guid{}) return 0;
  const auto known = std::find_if(last_.begin(), last_.end(), [&](const auto& entry) {
    return entry.first == identity.writer;
  });
  if (known == last_.end()) {
    if (last_.size() == kMaxWriters) last_.erase(last_.begin());
    last_.emplace_back(identity.writer, identity.sequence_number);
    return 0;
  }
  const std::int64_t before = std::exchange(known->second, identity.sequence_number);
  if (identity.sequence_number <= before) return 0;
  const auto gap = static_cast<std::uint64_t>(identity.sequence_number - before - 1);
  missing_ += gap;
  return gap;
}

}  // namespace strata::runtime
