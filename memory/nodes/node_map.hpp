// SPDX-License-Identifier: Apache-2.0
/// What a timescale memory expects to see: an immutable snapshot for localization, publishing and
/// pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "memory/decoding/decode.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/levels/polar_bins.hpp"
#include "memory/nodes/node_outline.hpp"

namespace strata::memory {

/// Made by TimescaleMemory::decode. Thread-safe, since immutable; share it as
/// std::shared_ptr<const NodeMap>.
class NodeMap {
 public:
  /// One level of one node, decoded.
  struct Level {
    std::uint64_t insertions = 0;  ///< of the NodeLevel it was decoded from
    DecodedScan scan;
    NodeOutline outline;
  };
  struct Node {
    Eigen::Vector2d position_m;
    std::uint64_t observations = 0;
    std::vector<std::shared_ptr<const Level>> levels;
  };

  NodeMap(const PolarBins& bins, double reach_m, const DecodingConfig& decoding,
          std::vector<std::string> level_names, std::vector<Node> nodes);
  [[nodiscard]] static std::shared_ptr<const Level> make_level(const PolarBins& bins,
                                                               double own_place_m,
                                                               std::uint64_t insertions,
                                                               DecodedScan scan);

  [[nodiscard]] const PolarBins& bins() const { return bins_; }
  [[nodiscard]] const DecodingConfig& decoding() const { return decoding_; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<std::string>& level_names() const { return level_names_; }
  /// Place of a level by name; throws ConfigError that lists the names there are.
  [[nodiscard]] int level_index(const std::string& name) const;

  /// The node that speaks for a place in this level: of those within reach whose outline holds the
  /// place, the nearest; -1 for none. To within half a look-up cell (0.125 m). O(1).
  [[nodiscard]] int node_at(int level, const Eigen::Vector2d& point_m) const;

  /// What a scanner at the node, turned like the map, would see: one beam per angle bin, at bin
  /// centres; +Inf for "at least max_range_m", NaN where nothing is known.
  [[nodiscard]] Scan expected_scan(int level, int node) const;

  /// Range that a beam is expected to measure: where it meets the outline of node_at(level, laser).
  /// +Inf where it runs free to bins().max_range_m, beyond which nothing is ever known: a sensor
  /// model should take longer readings for no return. NaN where nothing is known. bearing_rad in
  /// the laser frame. O(1).
  [[nodiscard]] float expected_range_m(int level, const Pose2& map_from_laser,
                                       double bearing_rad) const;
  /// ... for many beams of one pose; equal lengths.
  void expected_ranges_m(int level, const Pose2& map_from_laser,
                         std::span<const double> bearings_rad, std::span<float> ranges_m) const;
  /// ... for beams given by their unit directions in the laser frame: saves the sines and cosines
  /// when the same beams are asked for at many poses.
  void expected_ranges_m(int level, const Pose2& map_from_laser,
                         std::span<const Eigen::Vector2d> directions,
                         std::span<float> ranges_m) const;

  /// Picture of a level: free where a node sees, occupied along its surfaces; where nodes disagree,
  /// the nearer one decides. O(nodes x cells within max_range_m).
  [[nodiscard]] ReflectionGrid level_map(int level, double resolution_m = 0.05) const;

  /// Resident size of the decoded outlines.
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] const Level& level(int level, int node) const {
    return *nodes_[static_cast<std::size_t>(node)].levels[static_cast<std::size_t>(level)];
  }
  void build_lookup();

  PolarBins bins_;
  double reach_m_;
  DecodingConfig decoding_;
  std::vector<std::string> level_names_;
  std::vector<Node> nodes_;
  std::vector<Grid<std::int32_t>> lookup_;  ///< per level: the node that speaks for a cell
};

}  // namespace strata::memory
