// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.hpp"

#include <cmath>

#include "core/scan/range_limit.hpp"

namespace strata {

BeamKind Scan::kind(std::size_t beam) const {
  const float range_m = ranges_m[beam];
  if (std::isnan(range_m)) return BeamKind::kInvalid;
  if (range_m >= range_limit_m(range_max_m)) return BeamKind::kNoReturn;
  // Zero is what many drivers send for a beam without an answer; it lies at the scanner itself.
  if (range_m < range_min_m || range_m <= 0.0F) return BeamKind::kTooClose;
  return BeamKind::kHit;
}

BeamCounts count_beams(const Scan& scan) {
  BeamCounts counts;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    switch (scan.kind(beam)) {
      case BeamKind::kHit:
        ++counts.hits;
        break;
      case BeamKind::kNoReturn:
        ++counts.no_returns;
        break;
      case BeamKind::kTooClose:
        ++counts.too_close;
        break;
      case BeamKind::kInvalid:
        ++counts.invalid;
        break;
    }
  }
  return counts;
}

}  // namespace strata
