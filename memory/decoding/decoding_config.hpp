// SPDX-License-Identifier: Apache-2.0
/// How every angle bin's likeliest range is found: docs/theory/timescale_memory.md, "Decoding".
#pragma once

#include <array>
#include <utility>

#include "core/base/config.hpp"

namespace strata::memory {

/// What an edge from range bin i of angle bin a to range bin j of the next one is worth, from the
/// pair counts C_ij.
enum class EdgeWeight {
  kJoint,        ///< C_ij / sum of all C (caption of figure 5 of [kessler2010what])
  kConditional,  ///< C_ij / sum of row i (its equation (4))
  kTolerant,     ///< conditional, counts summed over neighbouring range bins and smoothed
  kScene,        ///< free within a scene, dear between scenes; all bins vote (scene_graph.hpp)
};

/// What a path minimizes.
enum class PathCost {
  kReciprocal,  ///< sum of 1/p, as the paper does; not the most likely path
  kNegLog,      ///< sum of -ln p: the most likely path
};

enum class SearchMethod {
  kLayered,   ///< dynamic programming over the rows, all starts at once
  kDijkstra,  ///< one search per start, as the paper does
};

}  // namespace strata::memory

template <>
struct strata::EnumNames<strata::memory::EdgeWeight> {
  using enum strata::memory::EdgeWeight;
  static constexpr std::array<std::pair<strata::memory::EdgeWeight, const char*>, 4> values{
      {{kJoint, "joint"},
       {kConditional, "conditional"},
       {kTolerant, "tolerant"},
       {kScene, "scene"}}};
};
template <>
struct strata::EnumNames<strata::memory::PathCost> {
  using enum strata::memory::PathCost;
  static constexpr std::array<std::pair<strata::memory::PathCost, const char*>, 2> values{
      {{kReciprocal, "reciprocal"}, {kNegLog, "neglog"}}};
};
template <>
struct strata::EnumNames<strata::memory::SearchMethod> {
  using enum strata::memory::SearchMethod;
  static constexpr std::array<std::pair<strata::memory::SearchMethod, const char*>, 2> values{
      {{kLayered, "layered"}, {kDijkstra, "dijkstra"}}};
};

namespace strata::memory {

/// The default is the preset `exact_decoding`.
struct DecodingConfig {
  EdgeWeight edges = EdgeWeight::kTolerant;
  PathCost cost = PathCost::kNegLog;
  double smoothing = 0.1;  ///< kappa of the tolerant and scene weights
  SearchMethod search = SearchMethod::kLayered;
  double evidence = 0.1;  ///< w of the scene weights

  friend bool operator==(const DecodingConfig&, const DecodingConfig&) = default;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("edges", c.edges,
            {.doc = "joint, conditional or tolerant pair statistics, or scene",
             .preset = {"paper-timescale", "joint"}});
    v.field("cost", c.cost,
            {.doc = "reciprocal (the paper) or neglog (the most likely path)",
             .preset = {"paper-timescale", "reciprocal"}});
    v.field("smoothing", c.smoothing,
            {.doc = "pseudo-count of the tolerant and scene weights",
             .min = 0.0,
             .max = 100.0,
             .preset = {"paper-timescale", "0"}});
    v.field("evidence", c.evidence,
            {.doc = "power of a range bin's share of samples in the scene weights",
             .min = 0.0,
             .max = 1.0,
             .preset = {"paper-timescale", "0"}});
    v.field("search", c.search,
            {.doc = "layered or dijkstra; both find the same cost",
             .preset = {"paper-timescale", "dijkstra"}});
  }
};

/// The most likely consistent scan. Ranges that straddle a bin edge do not halve its probability.
[[nodiscard]] constexpr DecodingConfig exact_decoding() { return {}; }
/// The most believable whole scene: told apart by what was never seen together, chosen by all bins.
[[nodiscard]] constexpr DecodingConfig scene_decoding() {
  return {EdgeWeight::kScene, PathCost::kNegLog, 0.1, SearchMethod::kLayered, 0.1};
}
/// As the paper's figures behave; goes with TimescaleConfig::coupled_eviction.
[[nodiscard]] constexpr DecodingConfig paper_decoding() {
  return {EdgeWeight::kJoint, PathCost::kReciprocal, 0.0, SearchMethod::kDijkstra, 0.0};
}
/// As the paper's equation (4) reads, for study: it follows single outliers.
[[nodiscard]] constexpr DecodingConfig literal_decoding() {
  return {EdgeWeight::kConditional, PathCost::kReciprocal, 0.0, SearchMethod::kDijkstra, 0.0};
}

}  // namespace strata::memory
