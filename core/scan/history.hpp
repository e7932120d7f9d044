// SPDX-License-Identifier: Apache-2.0
/// Which scans of earlier runs learning goes on from, so that what a night costs does not grow with
/// the years: each place keeps so many passes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata {

struct HistoryConfig {
  int passes_per_place = 60;
  double half_life_days = 30.0;
  double place_m = 2.0;
  double pass_s = 120.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "passes_per_place", c.passes_per_place,
        {.doc = "passes by a place, in each of four headings, that maps go on from; 0: all, and "
                "every update costs more than the one before",
         .min = 0});
    v.field("half_life_days", c.half_life_days,
            {.doc = "a pass this much older is half as likely to be kept where there are more",
             .unit = "d",
             .min = 1e-3});
    v.field("place_m", c.place_m, {.doc = "edge of a place", .unit = "m", .min = 0.1});
    v.field("pass_s", c.pass_s,
            {.doc = "a pass is what one run saw from a place within this time",
             .unit = "s",
             .min = 1.0});
  }
};

/// Of each scan whether it stays. Scans of runs from `first_new_run` on all do, and do not count.
/// A place is a square of `place_m` and a quarter of all headings; a pass what one run saw from it
/// in one of the spans of `pass_s` that its stamps fall into. Where there are more than
/// `passes_per_place`, that many are drawn without replacement, weighed by 2^(-age / half-life)
/// [efraimidis2006weighted]. The draw of a pass depends on its span alone, of one span the newest
/// runs stay: neighbouring places keep the same ones, the order of the runs makes no difference,
/// and what was drawn once is drawn again from whatever is left of the others, so that forgetting
/// night by night is forgetting at once. Where stamps begin anew in each log the newest runs stay.
/// O(n log n).
[[nodiscard]] std::vector<bool> scans_to_keep(std::span<const PosedScan> scans, int first_new_run,
                                              const HistoryConfig& config);

}  // namespace strata
