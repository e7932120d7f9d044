// SPDX-License-Identifier: Apache-2.0
/// Scans of one scanner that claim the same moment: their order is only that of the file.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>

#include "components/log/log_reader.hpp"

namespace strata::log {

/// Says in the report how many scans have the stamp of the one before. where: before the sentence.
/// stamp_of: of an element of `scans`, which are sorted by it. O(scans).
template <typename Scans, typename StampOf>
void note_equal_stamps(const Scans& scans, const StampOf& stamp_of, const std::string& where,
                       ReadReport& report) {
  std::size_t count = 0;
  for (auto it = scans.begin(); it != scans.end() && std::next(it) != scans.end(); ++it) {
    count += stamp_of(*it) == stamp_of(*std::next(it)) ? 1 : 0;
  }
  if (count == 0) return;
  report.warnings.push_back(where + std::to_string(count) + " of " + std::to_string(scans.size()) +
                            " scans have the stamp of the one before: they are taken in the "
                            "order of the file, without time between them");
}

}  // namespace strata::log
