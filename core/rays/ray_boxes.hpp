// SPDX-License-Identifier: Apache-2.0
/// Which rays of a beam cross some boxes, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/rays/bundle_kernel.hpp"

namespace strata::rays {

/// A rectangle in the map.
struct RayBox {
  double min_x_m = 0.0;
  double min_y_m = 0.0;
  double max_x_m = 0.0;
  double max_y_m = 0.0;
  std::size_t number = 0;  ///< to tell it from others
};

/// A box relative to where each of several bundles starts, in columns of one entry a bundle.
struct BoxColumns {
  const double* min_x_m = nullptr;
  const double* min_y_m = nullptr;
  const double* max_x_m = nullptr;
  const double* max_y_m = nullptr;
  const double* near_m = nullptr;  ///< no ray comes to it before this; +infinity: it does not count
  /// Mark of cells there that rays go through; 0: none; below 0: of the only ones that end them.
  const double* hidden = nullptr;
  double name = 0.0;        ///< what is added to BoxCrossings::boxes; 0: nothing
  std::uint32_t place = 0;  ///< SingleRow::box
  bool is_uniform = false;  ///< rays that cross such boxes alone go to SingleRow
};

/// Where rays cross boxes; columns with room for one entry a bundle and kSlack more.
struct BoxCrossings {
  static constexpr std::size_t kSlack = BeamBundles::kVector;
  double* bundle = nullptr;  ///< number
  double* cosine = nullptr;  ///< direction in the map
  double* sine = nullptr;
  double* from_m = nullptr;  ///< first entry into any of the boxes
  double* to_m = nullptr;    ///< last exit from any of them, not beyond the ray's end
  double* boxes = nullptr;   ///< sum of the names of those that it crosses
  static constexpr std::size_t kNamed = 52;  ///< names 2^place that a sum can hold
};

/// BeamBundles::kVector bundles of which some cross a uniform box with a beam, and no box that is
/// not.
struct SingleRow {
  std::uint32_t beam = 0;
  std::uint32_t bundle = 0;  ///< first
  std::uint32_t box = 0;
};
/// Many of these; BeamBundles::kVector entries a row.
struct SingleRows {
  SingleRow* rows = nullptr;
  double* from_m = nullptr;  ///< entry into the box
  double* to_m = nullptr;    ///< exit; not beyond from_m: this bundle does not cross it
  double* hidden = nullptr;  ///< as BoxColumns
  std::size_t count = 0;
};

/// Fills `found` with the bundles of which ray `beam` crosses at least one box before end_m[n] (or
/// the bundles' limit), in their order, and returns how many; but those that cross uniform boxes
/// alone are added to `single`, the rows of one beam and the same bundles one after the other.
/// end_m: one entry a bundle. single: with room for boxes.size() rows more for each kVector
/// bundles.
std::size_t cross_boxes(const BeamBundles& bundles, std::size_t beam, const double* end_m,
                        std::span<const BoxColumns> boxes, const BoxCrossings& found,
                        SingleRows& single);

}  // namespace strata::rays
