// SPDX-License-Identifier: Apache-2.0
/// Beams without return: which of them saw that there is nothing, and which lost their return.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/scan/scan.hpp"

namespace strata {

struct NoReturnConfig {
  bool is_used = true;
  double max_drop_out_share = 0.1;
  double max_drop_out_rate = 0.05;
  double max_free_range_m = 12.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("is_used", c.is_used,
            {.doc = "beams without return say that nothing is there, where the scanner's returns "
                    "are found to drop out seldom; false: they say nothing"});
    v.field("max_drop_out_share", c.max_drop_out_share,
            {.doc = "they say nothing where more of them than this share met a surface that scans "
                    "shortly before and after saw",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field(
        "max_drop_out_rate", c.max_drop_out_rate,
        {.doc = "they say nothing beyond the distance up to which so much at most of what meets "
                "a surface drops out",
         .unit = "1",
         .min = 0.0,
         .max = 1.0});
    v.field("max_free_range_m", c.max_free_range_m,
            {.doc = "nor beyond this; 0: they say nothing", .unit = "m", .min = 0.0});
  }
};

/// What the beams without return of a log are taken for.
struct DropOuts {
  std::size_t no_returns = 0;  ///< that could be judged: of scans with others before and after
  std::size_t dropped = 0;     ///< of these: met a surface that was seen before and after
  std::size_t returned = 0;    ///< beams with return that met such a surface
  double free_range_m = 0.0;   ///< of the scanner that sees furthest; 0: they say nothing

  friend bool operator==(const DropOuts&, const DropOuts&) = default;
};

/// Sets `free_range_m` and `drop_outs` of scans. Of a scan with others of up to 3 s before and
/// after it, beams without return say nothing that would have met a surface which one of these
/// shows, as three neighbouring beams without a gap, and those of which fewer than three are in a
/// row.
/// Scanners, told apart by mounting and reach, are judged each by itself: a return dropped out
/// where scans before and after both show the surface; a gate that opens or closes, and what comes
/// and goes, is there only before or only after. A scanner's beams say nothing where too many of
/// them dropped out, from the distance on at which too many of its beams do, where next to none
/// return from the last quarter of its reach, where too few can be judged, and where its reach is
/// not told (`tells_reach`); nor do those of a scan without others before and after.
/// Ours: docs/theory/beam_filter.md, "No-return beams". scans: in order of run and time, at poses
/// good to a fraction of a metre from one scan to the next. What was set before is forgotten. The
/// same bits for any number of threads. O(beams of scans with such beams, and scans x scanners).
[[nodiscard]] DropOuts find_drop_outs(std::span<PosedScan> scans, const NoReturnConfig& config,
                                      WorkerPool& pool);

}  // namespace strata
