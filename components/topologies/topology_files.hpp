// SPDX-License-Identifier: Apache-2.0
/// What topological mapping leaves behind: topologies.json, topology.graphml, places.yaml,
/// occupancy.{yaml,pgm} and trajectory.tum. The direct path and the component both write through
/// here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/topology/topology_map.hpp"

namespace strata::topologies {

/// One topology as a graph: landmarks with the mean pose and covariance of their first visit, edges
/// with how often they were driven. locations: of every visit, may be empty (no covariances).
/// names: of every landmark (topology::PlaceNames), may be empty.
[[nodiscard]] nlohmann::json topology_json(const topology::Hypothesis& hypothesis,
                                           const std::vector<Pose2Gaussian>& locations,
                                           const std::vector<int>& names = {});
/// The same graph as GraphML (graphml.graphdrawing.org): nodes with x, y, theta, covariance,
/// name and visits; edges with traversals.
[[nodiscard]] std::string topology_graphml(const topology::Hypothesis& hypothesis,
                                           const std::vector<Pose2Gaussian>& locations,
                                           const std::vector<int>& names = {});
/// A config file for `strata learn`: sub-maps follow the landmarks of this topology.
[[nodiscard]] std::string places_yaml(const topology::Hypothesis& hypothesis);
/// {"scans", "visits", "topologies", "diagnostics"}.
[[nodiscard]] nlohmann::json topologies_json(const topology::TopologyMap& map);

/// Writes the files into an existing folder, each whole or not at all; `json` becomes
/// topologies.json. A map without landmarks has no graph. Throws OutputError.
void write_topology_files(const std::filesystem::path& dir, const topology::TopologyMap& map,
                          const nlohmann::json& json);

}  // namespace strata::topologies
