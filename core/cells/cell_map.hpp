// SPDX-License-Identifier: Apache-2.0
/// A grid whose cells are Markov chains of two states, free and occupied
/// [meyerdelius2012occupancy; tipaldi2013lifelong] (docs/theory/cells.md).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "core/grid/tiled_grid.hpp"
#include "core/patch/chain.hpp"

namespace strata::cells {

/// How cells are learned and followed. Not settings: a model to compare with, as it was chosen.
struct CellConfig {
  /// P(a beam that reaches the cell ends in it). A share of hits of 0.26 speaks for neither, about
  /// kOccupiedReflection.
  double hit_if_occupied = 0.6;
  double hit_if_free = 0.05;
  /// A look at a cell ends when nothing was seen of it for so long, or when it took so long.
  double gap_s = 10.0;
  double max_look_s = 30.0;
  double min_look_nats = 1.0;  ///< less evidence decides nothing
  /// P(a look that decides is wrong). Chains see pairs of looks: errors would pass for changes, and
  /// changes for errors, were it much more.
  double look_error = 0.001;
  patch::ChainConfig chain;
  // While localizing:
  double max_scan_nats = 1.0;  ///< what one scan says of a cell: its beams are not independent
  double max_nats = 4.6;       ///< what all scans say: 0.99
  /// What scans changed is shown only so often: at once, the robot would pull what it sees along
  /// with the errors of its own pose.
  double refresh_s = 20.0;
  double min_score = 0.5;  ///< of the pose that cells learn from
};

struct CellState {
  float usual = 0.0F;       ///< P(occupied) by the stationary law
  float rate_per_s = 0.0F;  ///< gamma of patch::Chain
  float log_odds = 0.0F;    ///< of occupied, at `stamp`; as learned, those of what is usual
  bool is_known = false;
  Stamp stamp;

  [[nodiscard]] bool is_usually_occupied() const { return usual >= 0.5F; }
  [[nodiscard]] bool is_occupied() const { return log_odds >= 0.0F; }
};

[[nodiscard]] inline double probability_of(double log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds));
}
[[nodiscard]] inline double log_odds_of(double probability) {
  return std::log(probability) - std::log1p(-probability);
}

/// P(occupied dt_s later) of a chain: P usual + exp(-gamma dt) (P - usual).
[[nodiscard]] inline double faded(double occupied, const CellState& cell, double dt_s) {
  const auto usual = static_cast<double>(cell.usual);
  return usual + std::exp(-static_cast<double>(cell.rate_per_s) * dt_s) * (occupied - usual);
}

/// The cell goes on to `now`; clocks that were set back leave it as it is.
inline void fade_to(Stamp now, CellState& cell) {
  const double dt_s = (now - cell.stamp).seconds();
  cell.stamp = now;
  if (!(dt_s > 0.0)) return;
  const double occupied = faded(probability_of(static_cast<double>(cell.log_odds)), cell, dt_s);
  constexpr double kMin = 1e-6;
  cell.log_odds = static_cast<float>(log_odds_of(std::clamp(occupied, kMin, 1.0 - kMin)));
}

/// What beams say: hits, and lengths of the beams that pass in units of the cell's side [nats].
struct BeamEvidence {
  explicit BeamEvidence(const CellConfig& config)
      : hit(std::log(config.hit_if_occupied / config.hit_if_free)),
        miss(std::log((1.0 - config.hit_if_occupied) / (1.0 - config.hit_if_free))) {}
  double hit;
  double miss;
};

struct CellMap {
  TiledGrid<CellState> cells;
  std::size_t known = 0;    ///< cells
  std::size_t changed = 0;  ///< ... that were seen in both states
  double rate_per_s = 0.0;  ///< gamma of cells that never changed
  double sightings = 0.0;   ///< of each state, believed to have been seen in each cell beforehand
};

}  // namespace strata::cells
