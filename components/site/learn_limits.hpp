// SPDX-License-Identifier: Apache-2.0
/// What zones of kind learn say to those who learn.
#pragma once

#include <cstdint>
#include <filesystem>

#include "components/site/zones.hpp"
#include "core/grid/grid.hpp"

namespace strata::site {

/// Cells with 1; both grids are empty where no zone says so.
struct LearnLimits {
  Grid<std::uint8_t> never;        ///< nothing is learned there
  Grid<std::uint8_t> static_only;  ///< nothing changes there
};

/// O(cells of the zones). Throws InputError where the zones reach too far.
[[nodiscard]] LearnLimits learn_limits(const Zones& zones, double resolution_m);

/// The zones of a site, or of a GeoJSON file. Throws InputError.
[[nodiscard]] Zones zones_at(const std::filesystem::path& site_or_file);

}  // namespace strata::site
