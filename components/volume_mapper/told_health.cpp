// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/told_health.hpp"

#include <algorithm>
#include <iterator>

namespace strata::volume_mapper {

void ToldHealth::add(Stamp stamp, bool is_localized) {
  while (!told_.empty() && told_.back().stamp >= stamp) told_.pop_back();
  told_.push_back({stamp, is_localized});
  const Stamp oldest = stamp - Duration::from_seconds(keep_s_);
  while (told_.front().stamp < oldest) told_.pop_front();
}

std::optional<bool> ToldHealth::is_localized(Stamp begin, Stamp end) const {
  const auto after = [this](Stamp stamp) {
    return std::find_if(told_.begin(), told_.end(),
                        [&](const Told& told) { return told.stamp >= stamp; });
  };
  const auto last = after(end);
  if (last == told_.end()) return std::nullopt;
  auto first = after(begin);
  // Before the first that was told nothing is known, also not that it was lost.
  if (first->stamp > begin && first != told_.begin()) --first;
  return std::all_of(first, std::next(last), [](const Told& told) { return told.is_localized; });
}

}  // namespace strata::volume_mapper
