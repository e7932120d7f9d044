// SPDX-License-Identifier: Apache-2.0
/// Settings of the beam filter.
#pragma once

#include <array>
#include <utility>

#include "core/base/config.hpp"
#include "core/grid/counting_map.hpp"

namespace strata::beam_filter {

/// p(c = 1) over a whole log.
inline constexpr double kStaticPrior = 0.85;
/// ... within one visit of a place, a stay of a minute or so: less moves in it.
inline constexpr double kStaticPriorOfVisit = 0.9;

/// How the map at fixed poses is found.
enum class Mode {
  kClosedForm,  ///< the limit of EM at once (`closed_form`)
  kIterate,     ///< E-step and M-step in turn, as the paper describes it
};

struct BeamFilterConfig {
  Mode mode = Mode::kClosedForm;
  /// p(c = 1). Cells hit by a share of beams of at most (1 - p) / p become free.
  double prior = kStaticPrior;
  double resolution_m = 0.05;
  /// Cells with less evidence stay unknown.
  double min_evidence = 0.5;
  bool endpoint_tolerance = true;
  int max_iterations = 10;
  double min_gain = 1e-4;
  CountingOptions counting;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("mode", c.mode,
            {.doc = "how the map at fixed poses is found", .preset = {"paper-em", "iterate"}});
    v.field("prior", c.prior,
            {.doc = "probability that a beam hits something static; cells hit by a share of at "
                    "most (1 - prior) / prior of their beams become free",
             .unit = "1"});
    v.require(c.prior > 0.5, "prior",
              "is one half or less, where every cell that a single beam passed becomes free and "
              "no map is left",
              "choose a value above 0.5, such as 0.85");
    v.require(c.prior < 1.0, "prior",
              "is 1 or more, which rules dynamic objects out before looking",
              "choose a value below 1, such as 0.85");
    v.field(
        "resolution_m", c.resolution_m,
        {.doc = "edge of a cell",
         .unit = "m",
         .min = 0.005,
         .max = 10.0,
         .when = "maps shall be finer or coarser; time and memory grow with the number of cells"});
    v.field("min_evidence", c.min_evidence,
            {.doc = "a cell with less evidence (beam ends plus cells passed) stays unknown",
             .unit = "beams",
             .min = 1e-6});
    v.field(
        "endpoint_tolerance", c.endpoint_tolerance,
        {.doc = "judge a beam end by the most reflecting cell of the 3 x 3 around it: noise puts "
                "a part of a wall's beams into the cell before it, where most beams pass; "
                "false: the paper's form",
         .preset = {"paper-em", "false"}});
    v.field("max_iterations", c.max_iterations,
            {.doc = "most rounds of EM in mode iterate", .unit = "1", .min = 1.0});
    v.field("min_gain", c.min_gain,
            {.doc = "iterate stops after two rounds that each raise the log likelihood by less "
                    "than this share of it",
             .unit = "1",
             .min = 0.0});
    v.group("counting", c.counting, "how beams are counted");
  }
};

}  // namespace strata::beam_filter

template <>
struct strata::EnumNames<strata::beam_filter::Mode> {
  static constexpr std::array<std::pair<strata::beam_filter::Mode, const char*>, 2> values{{
      {strata::beam_filter::Mode::kClosedForm, "closed_form"},
      {strata::beam_filter::Mode::kIterate, "iterate"},
  }};
};
