// SPDX-License-Identifier: Apache-2.0
/// What `strata topology` writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/topology.hpp"
#include "tools/report/drawings.hpp"

namespace strata::pipeline {

/// topologies.json, topology.graphml (the likeliest), occupancy.{yaml,pgm} and trajectory.tum.
/// Returns what topologies.json holds. Throws OutputError.
nlohmann::json write_topology(const std::filesystem::path& dir, const std::string& log,
                              const TopologyMap& result, const Cost& cost,
                              const std::optional<TopologyAgreement>& agreement = {});

/// The pictures beside them: topologies.png, landmarks.png, odometry.png, map.png (figures 3, 4, 6,
/// 7 and 11 of [ranganathan2006rao]).
void write_topology_pictures(const std::filesystem::path& dir, const TopologyMap& result,
                             report::Drawings& drawings);

/// Pictures as SVG: the likeliest topologies with their probabilities; the landmarks of the
/// likeliest with its local clouds and covariance ellipses.
[[nodiscard]] std::string draw_topologies(const TopologyMap& result, std::size_t count);
[[nodiscard]] std::string draw_landmarks(const TopologyMap& result);

}  // namespace strata::pipeline
