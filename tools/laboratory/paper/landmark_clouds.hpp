// SPDX-License-Identifier: Apache-2.0
/// The local clouds of the landmarks of a topology, those of a landmark's visits laid together
/// [ranganathan2006rao, figure 1].
#pragma once

#include <cstddef>
#include <span>

#include "core/topology/topology_filter.hpp"
#include "core/topology/visit_maker.hpp"
#include "tools/laboratory/paper/svg_drawing.hpp"

namespace strata::paper {

struct CloudAgreement {
  std::size_t landmarks = 0;
  std::size_t with_cloud = 0;          ///< all of whose visits have one
  std::size_t pairs = 0;               ///< of visits of one landmark ...
  std::size_t overlapping = 0;         ///< ... whose clouds overlap at the poses of the topology
  std::size_t others = 0;              ///< pairs of first visits of two landmarks ...
  std::size_t others_overlapping = 0;  ///< ... whose clouds would, laid on each other
};

/// Share of the points of the smaller cloud that lie within 0.2 m of a point of the other; 0 where
/// one is empty. O(points).
[[nodiscard]] double overlap(const topology::LocalCloud& a, const topology::LocalCloud& b,
                             const Pose2& a_from_b);

/// Two clouds overlap when half of the smaller one does. visits: one a label of the hypothesis.
[[nodiscard]] CloudAgreement cloud_agreement(std::span<const topology::MadeVisit> visits,
                                             const topology::Hypothesis& hypothesis);

/// A tile a landmark with its number, in the frame of its first visit; a colour a visit.
[[nodiscard]] SvgDrawing draw_clouds(std::span<const topology::MadeVisit> visits,
                                     const topology::Hypothesis& hypothesis);

}  // namespace strata::paper
