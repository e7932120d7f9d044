// SPDX-License-Identifier: Apache-2.0
/// What is believed of the cells while scans come in (docs/theory/cells.md, "Localizing").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/cells/cell_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::cells {

/// 1 where occupied by the stationary law, 0 where free, unknown elsewhere. O(area).
[[nodiscard]] ReflectionGrid usual_grid(const CellMap& map);

/// Each cell fades to what is usual as its chain says, and takes in the beams that reach it. One
/// map for all particles. Cells that the map does not know stay unknown.
class CellBeliefs {
 public:
  explicit CellBeliefs(const CellMap& map, const CellConfig& config = {});

  /// Beams that end outside the map are left out. No allocation once it is warm.
  /// O(beams x cells a beam crosses).
  void observe(const Scan& scan, const Pose2& map_from_laser);

  /// Brings grid() up to date when it is older than config.refresh_s, or `now` lies before it.
  /// Returns whether it changed. O(cells that are not as usual).
  [[nodiscard]] bool refresh(Stamp now);

  /// 1 where occupied is more probable, else 0; unknown where nothing is known. At first what is
  /// usual.
  [[nodiscard]] const ReflectionGrid& grid() const { return grid_; }
  /// P(occupied) at that time; nothing where nothing is known.
  [[nodiscard]] std::optional<double> occupied(const Eigen::Vector2d& point_m, Stamp at) const;
  [[nodiscard]] std::size_t bytes() const {
    return cells_.allocated_bytes() + grid_.size() * sizeof(float);
  }

 private:
  struct Followed {
    CellState state;
    float nats = 0.0F;        ///< of the scan that is taken in
    std::uint32_t scan = 0;   ///< that reached it last
    std::uint32_t index = 0;  ///< in grid_
    bool is_listed = false;   ///< in `listed_`
    bool is_shown = false;    ///< occupied in grid_
  };
  void touch(double nats, Followed& cell);
  void take_in(Stamp now, Followed& cell);

  CellConfig config_;
  BeamEvidence evidence_;
  TiledGrid<Followed> cells_;
  ReflectionGrid grid_;
  std::vector<Followed*> touched_;
  std::vector<Followed*> listed_;  ///< shown, or believed, otherwise than usual
  std::uint32_t scan_ = 0;
  std::optional<Stamp> refreshed_;
};

}  // namespace strata::cells
