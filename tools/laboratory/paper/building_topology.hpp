// SPDX-License-Identifier: Apache-2.0
/// The topology of a real building, and how far it is true: what figures 1, 4, 6, 7, 9 and 11 of
/// [ranganathan2006rao] are judged by.
#pragma once

#include <string>
#include <vector>

#include "tools/laboratory/paper/figure.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/pipeline/topology.hpp"

namespace strata::paper {

/// A log with true poses, by their files in the folder of the real logs.
struct Building {
  std::string name;
  std::string log;
  std::string truth;
  double precision_m = 0.05;  ///< how well the true poses tell the distance of two places
};
[[nodiscard]] Building freiburg_079();

struct BuildingTopology {
  pipeline::TopologyMap map;
  pipeline::TopologyAgreement pairs;  ///< of the likeliest topology, near: within 1 m
  double error_m = 0.0;               ///< mean of the map's poses after alignment
};
/// match_scans: odometry is corrected by matching scans; otherwise raw. Throws InputError.
[[nodiscard]] BuildingTopology topology_of(const Setting& setting, const Building& building,
                                           bool match_scans = true);

/// No pair of places 2 m apart is one landmark, and at least 90% of those within 1 m, of which
/// there is one at least, are.
[[nodiscard]] bool is_true(const pipeline::TopologyAgreement& pairs);
/// Whether the map's poses are at most 0.5 m off on average.
[[nodiscard]] bool is_consistent(const BuildingTopology& topology);
/// What is_true() looks at, in so many words.
[[nodiscard]] std::vector<Number> numbers_of(const BuildingTopology& topology);
/// One of the pictures of `strata topology` (map.png, landmarks.png, ...); nothing where it cannot
/// be drawn.
[[nodiscard]] std::vector<Picture> picture_of(const BuildingTopology& topology,
                                              const std::string& file, const std::string& name,
                                              const std::string& caption);

}  // namespace strata::paper
