// SPDX-License-Identifier: Apache-2.0
/// Figures 6 to 8 of [kessler2010what] on what was really seen from a place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "memory/levels/node_level.hpp"
#include "tools/laboratory/experiments/place_views.hpp"

namespace strata::experiments {

/// A way to read a level; the paper's also learns in its own way.
struct NamedDecoder {
  std::string name;
  bool coupled_eviction = false;
  std::function<std::vector<float>(const memory::NodeLevel&)> ranges;
};
/// scene, exact, paper (Dijkstra), literal, median of each bin.
[[nodiscard]] std::vector<NamedDecoder> paper_decoders();
/// One of them. Throws Error for another name.
[[nodiscard]] NamedDecoder decoder_named(const std::string& name);

/// A level of `samples` that takes in every view, drawn at random from those of a state.
struct PlaceFigures {
  memory::PolarBins bins;
  int samples = 20;
  int seeds = 20;
  std::uint64_t first_seed = 1;
};

/// Figure 6: after 2 x samples views of the first state come 60 of the second.
struct SwitchResult {
  double first_scan = 0.0;  ///< after which at least 95% of the object's bins show it, mean
  double share = 0.0;       ///< of the object's samples that show it by then, mean ...
  double min_share = 1.0;   ///< ... and over the seeds
  double greatest_share = 0.0;
  double mixed = 0.0;         ///< scans decoded on the way that show 5 to 95% of it, mean
  int never = 0;              ///< seeds in which it never shows
  std::vector<double> shown;  ///< share of the bins after each view, first seed
};
[[nodiscard]] SwitchResult switch_states(const TwoStates& states, const NamedDecoder& decoder,
                                         const PlaceFigures& figures);

/// Figure 7: five views of the second state, then 80 in which the second half of the object's bins
/// is hidden. In how many seeds at least 95% of that half shows the second state all the same.
/// Pairs leave on their own with every decoder: with the paper's removal no path is left at the
/// edge of the view.
struct CompletionResult {
  int complete = 0;
  std::vector<float> decoded_m;  ///< first seed
};
[[nodiscard]] CompletionResult complete_half(const TwoStates& states, const NamedDecoder& decoder,
                                             const PlaceFigures& figures);

/// Figure 8: `before` are views at the right pose, `after` at a wrong one. Share of the bins that
/// show the wrong one when that share of 100 views is of it, mean over the seeds.
[[nodiscard]] double wrong_bins(const TwoStates& states, const NamedDecoder& decoder, double share,
                                const PlaceFigures& figures);

}  // namespace strata::experiments
