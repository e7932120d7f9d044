// SPDX-License-Identifier: Apache-2.0
/// What a timescale memory expects to see: an immutable snapshot for localization, publishing and
/// pictures.
#pragma once

#include <array>
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
    /// Not decoded yet: its levels expect nothing.
    bool is_pending = false;
  };

  /// previous: a snapshot whose look-up table may be shared, and only grows by the nodes that have
  /// come since, or null. A table leaves out what a node comes to see (a door that opens) until it
  /// is made anew, after a hundred snapshots.
  NodeMap(const PolarBins& bins, const DecodingConfig& decoding,
          std::vector<std::string> level_names, std::vector<Node> nodes,
          const NodeMap* previous = nullptr);
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

  /// A place seen from the nodes around it: the nearest ones whose outline in this level holds it,
  /// nearest first. Made once for all beams of a pose.
  class View {
   public:
    [[nodiscard]] bool empty() const { return size_ == 0; }
    /// The nearest node; requires !empty().
    [[nodiscard]] int node() const { return seen_[0].node; }

   private:
    friend class NodeMap;
    struct Seen {
      int node = -1;
      const NodeOutline* outline = nullptr;
      NodeOutline::Viewpoint from;
    };
    static constexpr std::size_t kMax = 4;
    Eigen::Vector2d place_m_ = Eigen::Vector2d::Zero();
    int level_ = 0;
    std::array<Seen, kMax> seen_;
    std::size_t size_ = 0;
  };
  /// Empty where no node sees the place. O(1). Valid as long as this map.
  [[nodiscard]] View view(int level, const Eigen::Vector2d& point_m) const;
  /// How far a beam from the view's place goes in the direction (unit, map frame). The nearest node
  /// decides; where a surface hides the end of the beam from it, the next node is asked, as long as
  /// it does not contradict: the way is free at least as far as the nearest node has seen it. When
  /// none of them sees the end, the nodes around the place where the beam leaves their sight are
  /// asked in the same way, a few times over. What lies beyond max_range_m is kOpen, a free way
  /// into the unknown. O(1).
  [[nodiscard]] NodeOutline::Reach reach(const View& view, const Eigen::Vector2d& direction) const;
  /// ... of many beams, fastest in order of bearing; equal lengths.
  void reach(const View& view, std::span<const Eigen::Vector2d> directions,
             std::span<NodeOutline::Reach> reach) const;

  /// The nearest node that sees the place in this level; -1 for none.
  [[nodiscard]] int node_at(int level, const Eigen::Vector2d& point_m) const;

  /// What a scanner at the node, turned like the map, would see: one beam per angle bin, at bin
  /// centres; +Inf for "at least max_range_m", NaN where no surface is known.
  [[nodiscard]] Scan expected_scan(int level, int node) const;

  /// Range that a beam is expected to measure, as `reach` finds it: +Inf where it runs free to
  /// bins().max_range_m, beyond which nothing is ever known: a sensor model should take longer
  /// readings for no return. NaN where nothing is known. bearing_rad in the laser frame. O(1).
  [[nodiscard]] float expected_range_m(int level, const Pose2& map_from_laser,
                                       double bearing_rad) const;
  /// ... for many beams of one pose; equal lengths.
  void expected_ranges_m(int level, const Pose2& map_from_laser,
                         std::span<const double> bearings_rad, std::span<float> ranges_m) const;

  /// Picture of a level: free where a node sees, occupied along its surfaces; where nodes disagree,
  /// the nearer one decides. O(nodes x cells within max_range_m).
  [[nodiscard]] ReflectionGrid level_map(int level, double resolution_m = 0.05) const;

  /// Resident size of the decoded outlines.
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// Nodes that see something of a look-up cell, nearest first, as many as fit; the rest is -1.
  static constexpr std::size_t kMaxAround = 8;
  using Around = std::array<std::int32_t, kMaxAround>;

  [[nodiscard]] const Level& level(int level, int node) const {
    return *nodes_[static_cast<std::size_t>(node)].levels[static_cast<std::size_t>(level)];
  }
  static constexpr std::size_t kMaxAtOnce = 64;
  /// At most kMax beams.
  template <std::size_t kMax>
  static void reach_in_sight(const View& view, std::span<const Eigen::Vector2d> directions,
                             std::span<NodeOutline::Reach> reach);
  /// Where a beam leaves the nodes' sight, from there.
  void go_on(const View& view, const Eigen::Vector2d& direction, NodeOutline::Reach& reach) const;
  /// The other's look-up table still holds, but for nodes filled since.
  [[nodiscard]] bool may_keep_lookup(const NodeMap& other) const;
  [[nodiscard]] std::vector<std::int32_t> filled_since(const NodeMap& other) const;
  [[nodiscard]] bool sees(const Node& node, const Eigen::Vector2d& center_m) const;
  void enter(std::int32_t node, Grid<Around>& lookup) const;
  [[nodiscard]] Grid<Around> empty_lookup() const;
  [[nodiscard]] Grid<Around> make_lookup() const;

  PolarBins bins_;
  DecodingConfig decoding_;
  std::vector<std::string> level_names_;
  std::vector<Node> nodes_;
  std::shared_ptr<const Grid<Around>> lookup_;
  int lookup_age_ = 0;  ///< snapshots that have shared it
};

}  // namespace strata::memory
