// SPDX-License-Identifier: Apache-2.0
/// The decoded scan of a node as a star polygon that beams can be cast against from nearby.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "memory/levels/polar_bins.hpp"

namespace strata::memory {

/// Corner a lies at the centre of angle bin a, at its decoded range, at max_range_m where the bin
/// is open, at the end of the free way where no more is known, and at the own-place radius where
/// nothing is. Gaps of up to three unknown bins
/// within one surface are bridged. Immutable, thread-safe.
class NodeOutline {
 public:
  /// What a beam meets at the edge from corner a to corner a + 1.
  enum class Edge : std::uint8_t {
    kSurface,  ///< something was seen there
    kOpen,     ///< nothing within max_range_m
    kHidden,   ///< the way on from there is hidden by a nearer surface, or beyond the scanner
    kUnseen,   ///< never seen: not even the way to it is known to be free
  };

  NodeOutline(const PolarBins& bins, double own_place_m, std::span<const float> range_m);

  /// Whether a point, relative to the node, lies inside.
  [[nodiscard]] bool contains(const Eigen::Vector2d& point_m) const;

  /// A place that beams start from, relative to the node; made once for all its beams.
  struct Viewpoint {
    Eigen::Vector2d from_m;
    bool inside = false;        ///< inside the outline
    bool within_inner = false;  ///< nearer to the node than any edge
    std::size_t sector = 0;     ///< where the walk begins, unless within_inner
  };
  [[nodiscard]] Viewpoint view_from(const Eigen::Vector2d& from_m) const;

  /// How far a beam goes freely inside, and what it meets there.
  struct Reach {
    double range_m = 0.0;
    Edge end = Edge::kUnseen;
    /// Whether no more is said than that the way is free so far, for a scanner of that reach.
    [[nodiscard]] bool is_open_ended(double r_max_m) const {
      return end != Edge::kSurface && range_m < r_max_m;
    }
  };
  /// In the direction (unit). Nothing, {0, kUnseen}, from a viewpoint outside. O(corners passed):
  /// few, since everything within the nearest edge's distance is skipped, and corners that lie
  /// further off than the beam are passed eight at once.
  [[nodiscard]] Reach cast(const Viewpoint& view, const Eigen::Vector2d& direction) const;
  [[nodiscard]] Reach cast(const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction) const {
    return cast(view_from(from_m), direction);
  }
  /// ... of many beams; equal lengths. Those of a scan, which are in order of bearing, take
  /// O(beams + corners) together; any order is right.
  void cast(const Viewpoint& view, std::span<const Eigen::Vector2d> directions,
            std::span<Reach> reach) const;

  [[nodiscard]] std::size_t size() const { return radius_m_.size(); }
  [[nodiscard]] Edge edge(std::size_t a) const { return edge_[a]; }
  [[nodiscard]] Eigen::Vector2d corner_m(std::size_t a) const {
    return {static_cast<double>(x_m_[a]), static_cast<double>(y_m_[a])};
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] std::size_t next(std::size_t a) const { return a + 1 == size() ? 0 : a + 1; }
  [[nodiscard]] std::size_t previous(std::size_t a) const { return (a == 0 ? size() : a) - 1; }
  /// Index of the sector, from corner a to the next, that the direction lies in; near a corner
  /// (1e-4 rad) it may be the one beside.
  [[nodiscard]] std::size_t sector_of(double x, double y) const;
  /// Whether a point of that sector is on the node's side of the sector's edge.
  [[nodiscard]] bool is_within(const Eigen::Vector2d& point_m, std::size_t sector) const;
  /// The first sector of the beam that may hold its end.
  [[nodiscard]] std::size_t begin(const Viewpoint& view, const Eigen::Vector2d& direction) const;
  /// As cast, of those that turn this way round the node.
  template <bool kTurnsLeft>
  void sweep(const Viewpoint& view, std::span<const Eigen::Vector2d> directions, bool backwards,
             std::span<Reach> reach) const;
  /// From the sector on to the one that the beam leaves the outline in. moment: the cross product
  /// of the beam's start and direction; its sign is that of the turn.
  template <bool kTurnsLeft>
  [[nodiscard]] std::size_t follow(std::size_t sector, double moment,
                                   const Eigen::Vector2d& direction) const;
  [[nodiscard]] Reach meet(std::size_t sector, const Eigen::Vector2d& from_m,
                           const Eigen::Vector2d& direction) const;
  void bridge_gaps(std::vector<bool>& known, std::vector<bool>& free_end);
  void classify_edges(const std::vector<bool>& known, const std::vector<bool>& open,
                      const std::vector<bool>& free_end);
  void measure_blocks();

  double bins_per_rad_ = 1.0;
  double inner_m_ = 0.0;  ///< no edge is nearer to the node
  std::vector<float> radius_m_;
  std::vector<float> x_m_;
  std::vector<float> y_m_;
  std::vector<Edge> edge_;
  /// The corners in groups of neighbours, that a beam may pass together.
  struct Block {
    float first_scale;  ///< from the block's first corner to its smallest radius
    float last_scale;
  };
  std::vector<Block> block_;
};

}  // namespace strata::memory
