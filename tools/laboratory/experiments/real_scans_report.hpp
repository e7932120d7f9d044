// SPDX-License-Identifier: Apache-2.0
/// The experiments of [kessler2010what] on real logs, as tables and plots.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/laboratory/experiments/place_figures.hpp"
#include "tools/laboratory/experiments/place_views.hpp"
#include "tools/laboratory/experiments/put_object.hpp"

namespace strata::experiments {

struct PlaceOptions {
  Occasion before;
  Occasion after;
  /// Where the node stands, in the frame of the poses; empty: where most has changed.
  std::optional<Eigen::Vector2d> place_m;
  double radius_m = 1.0;  ///< scans taken within this count
  /// Put into the second occasion's scans, before where the first of them was taken; the node then
  /// stands there unless place_m says otherwise.
  std::optional<Board> object;
  double min_difference_m = 0.5;
  int seeds = 20;
  std::uint64_t first_seed = 1;
  std::filesystem::path out;
};

/// Prints figures 6, 7 and 8 of one place as Markdown tables and writes place_figure_6.png,
/// place_figure_7.png and place_figure_8.png. In figure 8 scans of the second occasion are taken
/// for ones from 0.3 m and 0.1 rad aside. Throws InputError.
void report_place(const PlaceOptions& options);

/// For each log, with its poses, the decoders on the memory that it leaves, and table 1: prints
/// them. Throws InputError.
void report_decoders(const std::vector<Occasion>& logs);

}  // namespace strata::experiments
