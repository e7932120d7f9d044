// SPDX-License-Identifier: Apache-2.0
/// The map of a robot that is mapping: follows what a Slam knows by the work that there is.
#pragma once

#include <cstddef>
#include <vector>

#include "core/beam_filter/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/slam/slam.hpp"

namespace strata::slam {

/// Counts of the scans that entered the map, each where it is known to have been taken now: where a
/// loop closure moves some, those are counted anew. What was counted of a scan that Slam has
/// forgotten since stays. Memory: the cells, and a pose a kept scan. Not thread-safe.
class LiveMap {
 public:
  /// Throws ConfigError.
  explicit LiveMap(const beam_filter::BeamFilterConfig& config);

  /// Counts what has come since, and, of the scans that have moved by half a cell or more, so many
  /// anew. True when nothing is left to do. O(what is kept) and O(beams x cells a beam crosses) for
  /// each scan counted.
  bool update(const Slam& slam, std::size_t max_moved);

  /// Whether the map is another than when this was asked last.
  [[nodiscard]] bool take_news();
  /// Whether scans have moved since this was asked last.
  [[nodiscard]] bool take_moves();
  /// Counted, and kept by Slam as of the last update.
  [[nodiscard]] std::size_t scans() const { return counted_.size(); }
  /// Of all beams. O(cells).
  [[nodiscard]] ReflectionGrid occupancy() const;
  /// Of those held to be static, by the limit of EM on the counts. O(cells).
  [[nodiscard]] ReflectionGrid filtered() const;

 private:
  struct Counted {
    std::size_t number = 0;
    Pose2 map_from_robot;
  };
  void count(const PosedScan& scan, const Pose2& map_from_robot, double weight);

  beam_filter::BeamFilterConfig config_;
  CountingMap counts_;
  std::vector<Counted> counted_;  ///< by number
  PosedScan scratch_;
  bool has_news_ = false;
  bool has_moves_ = false;
};

}  // namespace strata::slam
