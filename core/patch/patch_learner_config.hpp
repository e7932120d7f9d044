// SPDX-License-Identifier: Apache-2.0
/// What patch maps are learned by, all scans at once or one by one.
#pragma once

#include "core/base/config.hpp"
#include "core/beam_filter/config.hpp"
#include "core/grid/counting_map.hpp"
#include "core/patch/chain.hpp"
#include "core/patch/contradiction.hpp"
#include "core/patch/model_selection.hpp"
#include "core/patch/recurrence.hpp"
#include "core/patch/region_growing.hpp"
#include "core/patch/sequences.hpp"
#include "core/patch/visits.hpp"
#include "core/scan/drop_outs.hpp"

namespace strata::patch {

struct PatchLearnerConfig {
  CountingOptions counting;
  NoReturnConfig no_return;
  VisitConfig visits;
  ContradictionConfig contradiction;
  RegionConfig regions;
  SequenceConfig sequences;
  ModelSelectionConfig clustering;
  ChainConfig chain;
  RecurrenceConfig recurrence;
  double prior = beam_filter::kStaticPriorOfVisit;
  double min_evidence = 0.5;
  bool keep_single_configuration = false;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("counting", c.counting, "how scans are counted");
    v.group("no_return", c.no_return, "what beams without return say");
    v.group("visits", c.visits, "what one visit is");
    v.group("contradiction", c.contradiction, "when visits contradict each other");
    v.group("regions", c.regions, "from contradictory cells to sub-maps");
    v.group("sequences", c.sequences, "which scans are one observation of a sub-map");
    v.group("clustering", c.clustering, "how many configurations, and which");
    v.group("chain", c.chain, "how often each configuration is there, and how fast they change");
    v.group("recurrence", c.recurrence, "which areas show the same things again");
    v.field("prior", c.prior,
            {.doc = "P(a beam ends on something static), for the beam filter within a sequence",
             .unit = "1",
             .min = 0.5,
             .max = 1.0});
    v.field("min_evidence", c.min_evidence,
            {.doc = "cells with less evidence are unknown", .unit = "beams", .min = 1e-3});
    v.field("keep_single_configuration", c.keep_single_configuration,
            {.doc = "keep areas whose sequences all show one configuration; they say no more than "
                    "the static map"});
    v.require(c.prior > 0.5, "prior", "is 0.5, where every cell turns free",
              "choose a value above 0.5, such as 0.9");
  }
};

}  // namespace strata::patch
