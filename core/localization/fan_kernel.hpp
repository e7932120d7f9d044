// SPDX-License-Identifier: Apache-2.0
/// The same beams from many places at once: particles lie close together, so that a beam takes
/// about as many steps from each, and vectors of particles wait less than vectors of beams.
#pragma once

#include <cstddef>

#include "core/localization/ray_kernel.hpp"

namespace strata::localization {

/// Fan n starts at (column[n], row[n]) of a table, turned by its heading; all have the same beams.
struct RayFans {
  /// Fans come in whole vectors, whatever the machine has.
  static constexpr std::size_t kVector = 8;
  const double* column = nullptr;  ///< RayTable::column_at, row_at
  const double* row = nullptr;
  const double* heading_cosine = nullptr;
  const double* heading_sine = nullptr;
  std::size_t count = 0;           ///< a multiple of kVector
  const double* cosine = nullptr;  ///< of each beam in its fan
  const double* sine = nullptr;
  std::size_t beams = 0;
  double max_range_m = 0.0;
};

/// range_m[b fans.count + n]: what cast_rays says of beam b of fan n, bit for bit.
void cast_fans(const RayTable& table, const RayFans& fans, double* range_m);

struct SingleRows;

/// The same for rows of fans from where they enter a box to where they leave it; range_m:
/// kVector entries a row, +infinity for fans that meet nothing there. The rows lie inside the
/// table.
void cast_rows(const RayTable& table, const RayFans& fans, const SingleRows& rows, double* range_m);

}  // namespace strata::localization
