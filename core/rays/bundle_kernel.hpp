// SPDX-License-Identifier: Apache-2.0
/// The same beams from many places at once: particles lie close together, so that a beam takes
/// about as many steps from each, and vectors of particles wait less than vectors of beams.
#pragma once

#include <cstddef>

#include "core/rays/ray_kernel.hpp"

namespace strata::rays {

/// Bundle n starts at (column[n], row[n]) of a table, turned by its heading; all have the same
/// beams.
struct BeamBundles {
  /// Bundles come in whole vectors, whatever the machine has.
  static constexpr std::size_t kVector = 8;
  const double* column = nullptr;  ///< RayTable::column_at, row_at
  const double* row = nullptr;
  const double* heading_cosine = nullptr;
  const double* heading_sine = nullptr;
  std::size_t count = 0;           ///< a multiple of kVector
  const double* cosine = nullptr;  ///< of each beam in its bundle
  const double* sine = nullptr;
  std::size_t beams = 0;
  double max_range_m = 0.0;
};

/// range_m[b bundles.count + n]: what cast_rays says of beam b of bundle n, bit for bit.
void cast_bundles(const RayTable& table, const BeamBundles& bundles, double* range_m);

struct SingleRows;

/// The same for rows of bundles from where they enter a box to where they leave it; range_m:
/// kVector entries a row, +infinity for bundles that meet nothing there. The rows lie inside the
/// table.
void cast_rows(const RayTable& table, const BeamBundles& bundles, const SingleRows& rows,
               double* range_m);

}  // namespace strata::rays
