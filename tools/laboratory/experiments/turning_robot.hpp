// SPDX-License-Identifier: Apache-2.0
/// A scanner of 180 degrees about a node that it is never at: what the node sees went through
/// [kessler2010what, eqs. (1) and (2)], and no scan shows all of it.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/scan/scan.hpp"
#include "tools/laboratory/experiments/place_figures.hpp"
#include "tools/laboratory/experiments/place_views.hpp"
#include "tools/simulate/world.hpp"

namespace strata::experiments {

/// A room of walls that no two directions share, a node within, and a board that comes to stand
/// 1 m before it.
struct BoardRoom {
  std::vector<simulate::Segment> walls;
  simulate::Segment board;
  Eigen::Vector2d node_m;
};
[[nodiscard]] BoardRoom board_room();

/// How the robot looks.
enum class Looking {
  kAnywhere,       ///< heading drawn from the whole circle
  kAtBoard,        ///< the board is ahead, up to 45 degrees aside
  kPastHalfBoard,  ///< the edge of the view lies at the middle of the board: one half is hidden
};

/// Scans of 180 beams from places up to 0.4 m from the node, a draw each; 1 cm of noise.
[[nodiscard]] std::vector<PosedScan> turned_scans(const BoardRoom& room, bool with_board,
                                                  Looking looking, int count, std::uint64_t seed);

/// Without and with the board. `before` and `after` are all views, those that show none of the
/// board too; `bins` are the board's.
[[nodiscard]] TwoStates board_states(const BoardRoom& room, const memory::PolarBins& bins,
                                     std::uint64_t seed);
/// At the true poses, and at poses 0.36 m and 0.1 rad beside them; `bins` are all that differ.
[[nodiscard]] TwoStates wrong_pose_states(const BoardRoom& room, const memory::PolarBins& bins,
                                          std::uint64_t seed);

/// Figure 7 with a robot that turns: the board comes, five views show all of it, then 80 one half.
struct TurnedAway {
  TwoStates states;
  std::vector<memory::VirtualScan> whole;   ///< views of all of the board
  std::vector<memory::VirtualScan> partly;  ///< views of one half
  std::vector<std::size_t> hidden;          ///< bins of the board that none of `partly` knows
};
[[nodiscard]] TurnedAway turn_away(const BoardRoom& room, const memory::PolarBins& bins,
                                   std::uint64_t seed);
/// In how many seeds at least 95% of the hidden bins show the board all the same.
[[nodiscard]] CompletionResult complete_turned(const TurnedAway& turned,
                                               const NamedDecoder& decoder,
                                               const PlaceFigures& figures);

}  // namespace strata::experiments
