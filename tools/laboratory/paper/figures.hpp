// SPDX-License-Identifier: Apache-2.0
/// Every figure and table of the four papers that shows a result.
#pragma once

#include <vector>

#include "tools/laboratory/paper/figure.hpp"

namespace strata::paper {

/// [stachniss2003chapter, section 1.5.1].
[[nodiscard]] std::vector<Figure> em_figures();
/// [stachniss2003chapter, section 1.5.2; stachniss2005patch, section V].
[[nodiscard]] std::vector<Figure> patch_figures();
/// [kessler2010what, section 5].
[[nodiscard]] std::vector<Figure> kessler_figures();
/// Figures 6 to 8 of it by scanners that never see all of a node.
[[nodiscard]] std::vector<Figure> kessler_turning_figures();
/// [ranganathan2006rao, section V].
[[nodiscard]] std::vector<Figure> ptm_figures();
/// Figure 1 of it, and what it shows of a second building.
[[nodiscard]] std::vector<Figure> ptm_cloud_figures();
[[nodiscard]] std::vector<Figure> ptm_building_figures();
/// Of the same section: the mass of the true topology in its two experiments.
[[nodiscard]] std::vector<Figure> ptm_mass_figures();
/// All of them.
[[nodiscard]] std::vector<Figure> all_figures();

}  // namespace strata::paper
