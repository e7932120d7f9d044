// SPDX-License-Identifier: Apache-2.0
#include "components/log/no_return_limit.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "components/log/text.hpp"
#include "core/scan/no_return.hpp"
#include "core/scan/range_limit.hpp"

namespace strata::log {
namespace {

std::string sentence(const NoReturnCode& code) {
  const std::string from = format_number(code.from_m);
  const std::string to = format_number(code.to_m);
  return std::to_string(code.readings) + " readings " +
         (from == to ? "of exactly " + from : "from " + from + " to " + to) + " m, " +
         std::to_string(code.below) + " in the metre below";
}

std::vector<NoReturnCode> codes_of(std::span<const RangedScan> scans) {
  std::vector<PlacedScan> placed;
  for (const RangedScan& ranged : scans) placed.push_back({ranged.scan, ranged.odom_from_robot});
  return find_no_return_codes(placed);
}

}  // namespace

void settle_no_returns(std::span<const RangedScan> scans, const std::string& scanner,
                       const std::string& stated, const ReadOptions& options, ReadReport& report) {
  NoReturnLimit limit{scanner, range_limit_m(scans.front().scan->range_max_m), stated};
  if (options.max_range_m > 0.0) {
    limit.from_m = static_cast<float>(options.max_range_m);
    limit.why = "as told (max_range_m)";
    for (const RangedScan& ranged : scans) set_range_limit(*ranged.scan, limit.from_m);
  } else if (const auto codes = codes_of(scans); !codes.empty()) {
    limit.from_m = codes.back().from_m;
    limit.why = "they pile up: ";
    for (const NoReturnCode& code : codes) {
      limit.why += (&code == &codes.front() ? "" : "; ") + sentence(code);
    }
    for (const RangedScan& ranged : scans) {
      const float own_m = range_limit_m(ranged.scan->range_max_m);
      set_range_limit(*ranged.scan, std::min(own_m, limit.from_m));
    }
    report.warnings.push_back((scanner.empty() ? "" : scanner + ": ") + "readings from " +
                              format_number(limit.from_m) + " m on are taken for no return, " +
                              limit.why + " (--max-range overrules it)");
  }
  report.no_returns.push_back(std::move(limit));
}

}  // namespace strata::log
