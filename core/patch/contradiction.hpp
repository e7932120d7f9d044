// SPDX-License-Identifier: Apache-2.0
/// Which cells different visits saw in different states [stachniss2005patch, "Map Segmentation"].
/// The paper names no test; ours is docs/theory/patch_maps.md, "Many visits" and "Few visits".
///
/// Two tests, and a cell is contradictory when one of them says so:
/// - many visits: a G-test of homogeneity per cell, with capped evidence and tolerance to jitter;
/// - few visits: no single cell has enough evidence, so neighbouring cells are pooled: a connected
///   component that one visit saw occupied and another saw free, all over at least
///   few_min_extent_m, or a smaller one that both saw with many beams.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/beam_filter/config.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

struct ContradictionConfig {
  double prior = beam_filter::kStaticPriorOfVisit;
  double tolerance_m = 0.15;
  double min_across = 1.0;
  double displaced_reach_m = 0.25;
  double max_displaced_share = 0.7;
  int min_component_cells = 8;
  // Many visits.
  double max_evidence = 4.0;
  double min_evidence = 0.5;
  double significance = 1e-4;
  double min_share = 0.05;
  int min_block_cells = 3;
  // Few visits.
  int few_max_visits = 10;
  double few_min_extent_m = 0.3;
  int few_min_cells = 8;
  double few_min_beams = 3.0;
  double few_occupied_share = 0.6;
  double few_free_share = 0.1;
  int few_strong_cells = 6;
  double few_strong_extent_m = 0.2;
  double few_strong_beams = 15.0;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("prior", c.prior,
            {.doc = "P(a beam ends on something static), for the beam filter within a visit",
             .unit = "1",
             .min = 0.5,
             .max = 1.0});
    v.field("tolerance_m", c.tolerance_m,
            {.doc = "a cell is free in a visit only when that visit hit nothing this close to it; "
                    "at least the neighbouring cells",
             .unit = "m",
             .min = 0.0,
             .max = 1.0});
    v.field(
        "min_across", c.min_across,
        {.doc =
             "a visit sees a cell free only when at least so much of what passed (or half of it) "
             "went across the surface that other visits saw there, not along it",
         .unit = "beams",
         .min = 0.0});
    v.field("displaced_reach_m", c.displaced_reach_m,
            {.doc = "how far errors of pose may displace a surface",
             .unit = "m",
             .min = 0.0,
             .max = 1.0});
    v.field(
        "max_displaced_share", c.max_displaced_share,
        {.doc = "a change is dropped when at least this share of where it was free lies within "
                "displaced_reach_m of what was hit then (the same surface, displaced; visits that "
                "hit within tolerance_m are not counted), or of surfaces that no visit found "
                "free; above 1 nothing is dropped",
         .unit = "1",
         .min = 0.0,
         .max = 1.1});
    v.field("min_component_cells", c.min_component_cells,
            {.doc = "a change of fewer connected cells is dropped, unless its evidence is strong "
                    "(few_strong_cells)",
             .unit = "cells",
             .min = 1});
    v.field("max_evidence", c.max_evidence,
            {.doc = "beams of one visit count at most this much: they are correlated",
             .unit = "beams",
             .min = 0.5});
    v.field("min_evidence", c.min_evidence,
            {.doc = "visits with less evidence are left out", .unit = "beams", .min = 1e-3});
    v.field(
        "significance", c.significance,
        {.doc = "chance per cell of a false contradiction", .unit = "1", .min = 0.0, .max = 1.0});
    v.field("min_share", c.min_share,
            {.doc = "the share of hits over all visits must lie this far from 0 and 1",
             .unit = "1",
             .min = 0.0,
             .max = 0.5});
    v.field("min_block_cells", c.min_block_cells,
            {.doc = "contradictory cells needed in the 3 x 3 block of each", .min = 1, .max = 9});
    v.field("few_max_visits", c.few_max_visits,
            {.doc = "cells with at most this many visits are also tested by pooling over space",
             .unit = "visits",
             .min = 0});
    v.field("few_min_extent_m", c.few_min_extent_m,
            {.doc = "least extent of a pooled component whose evidence is not strong",
             .unit = "m",
             .min = 0.0});
    v.field("few_min_cells", c.few_min_cells,
            {.doc = "least number of cells of a pooled component whose evidence is not strong",
             .unit = "cells",
             .min = 1});
    v.field("few_min_beams", c.few_min_beams,
            {.doc = "evidence a visit needs in a cell", .unit = "beams", .min = 0.5});
    v.field(
        "few_occupied_share", c.few_occupied_share,
        {.doc = "occupied: at least this share of hits; with many visits, one with fewer and hits "
                "beside the cell says nothing",
         .unit = "1",
         .min = 0.5,
         .max = 1.0});
    v.field("few_free_share", c.few_free_share,
            {.doc = "free: at most this share of hits", .unit = "1", .min = 0.0, .max = 0.5});
    v.field("few_strong_cells", c.few_strong_cells,
            {.doc = "least number of cells of a pooled component whose evidence is strong",
             .unit = "cells",
             .min = 1});
    v.field("few_strong_extent_m", c.few_strong_extent_m,
            {.doc = "least extent of a pooled component whose evidence is strong",
             .unit = "m",
             .min = 0.0});
    v.field("few_strong_beams", c.few_strong_beams,
            {.doc = "evidence is strong where at least so many beams a cell, in the mean over the "
                    "component, ended there in one visit, and so many of another went across",
             .unit = "beams",
             .min = 0.5});
    v.require(c.prior > 0.5, "prior", "is 0.5, where every cell turns free",
              "choose a value above 0.5, such as 0.9");
  }
};

/// P(X > x) for chi-squared with `dof` degrees of freedom, by the finite sums for whole dof.
/// Requires dof >= 1, x >= 0. O(dof).
[[nodiscard]] double chi_squared_tail(double x, int dof);

/// Evidence of one visit after capping and jitter tolerance.
struct VisitEvidence {
  double hits = 0.0;
  double misses = 0.0;
};
/// G = 2 sum_s [h_s ln(r_s / r) + f_s ln((1 - r_s) / (1 - r))] with r pooled: twice the
/// log-likelihood ratio of "each visit has its own share" to "all share one" [nats]. Chi-squared
/// with (visits - 1) degrees of freedom when nothing changed. Visits without evidence add nothing.
[[nodiscard]] double g_statistic(std::span<const VisitEvidence> visits);

/// P of a contrast as great as the greatest between m visits that saw the cell occupied and the
/// others, which saw it free, if all visits shared one rate: the tail of chi-squared (one degree of
/// freedom) of G of the two groups, times the ways to choose m of the visits, times the choices of
/// m (Bonferroni); 1 when no m makes such groups. Ours: G over all visits spreads over as many
/// degrees of freedom as there are visits, and so does not see a state that one or two of seventeen
/// visits saw. Asked where a cell has more than few_max_visits visits of any kind: among fewer the
/// test for few sees such a state, and asks that neighbours agree on the visits; by single cells,
/// walls seen through from one side alone would count as states. Sorts the visits. O(n log n).
[[nodiscard]] double two_states_tail(std::vector<VisitEvidence>& visits,
                                     const ContradictionConfig& config);

/// The test for many visits: 1 where contradictory, on the table's rectangle. Hits beside a cell
/// that was hit itself are of one surface, so its misses do not count in that visit; a visit that
/// mostly saw it free says nothing then. Expects visits after VisitTable::filter. O(visits).
[[nodiscard]] Grid<std::uint8_t> test_many_visits(const VisitTable& table,
                                                  const ContradictionConfig& config);

/// What test_few_visits says of a cell; 0: nothing.
inline constexpr std::uint8_t kContradictory = 1;
inline constexpr std::uint8_t kStronglyContradictory = 2;

/// The test for few visits: kContradictory in components of at least few_min_cells,
/// kStronglyContradictory in those of few_strong_cells whose cells, in the mean, few_strong_beams
/// hit in one visit and as many crossed in the other. That leaves out a surface that a visit grazed
/// with a beam or two, and people who walked by. On the table's rectangle.
/// Expects visits after VisitTable::filter. O(visits), and O(cells^2 pairs^2) a component.
[[nodiscard]] Grid<std::uint8_t> test_few_visits(const VisitTable& table,
                                                 const ContradictionConfig& config);

/// The union of both, without what displaced surfaces explain and without small components.
[[nodiscard]] Grid<std::uint8_t> find_contradictions(const VisitTable& table,
                                                     const ContradictionConfig& config);

}  // namespace strata::patch
