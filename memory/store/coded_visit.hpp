// SPDX-License-Identifier: Apache-2.0
/// A visit told relative to a map that both ends have: far less than it is by itself
/// (memory/store/visit_content.hpp), for a stated loss. docs/fleet.md, "Relative to a map", has the
/// layout.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::memory {

/// Beside kVisitFormat.
inline constexpr int kCodedVisitFormat = 2;

struct CodedVisit {
  std::vector<std::byte> bytes;
  std::vector<PosedScan> scans;  ///< what is read of them, bit for bit
};

/// Tells scans of one run, in order of time, relative to a map that has this hash (64 hexadecimal
/// digits). Poses go to the next centimetre and 4096th of a turn, stamps but the first to the next
/// 10 ms, or one after where two would be the same; beams that end within tolerance_m of where the
/// map says (or between what it says of them and the beams beside them, at most 0.3 m) end there,
/// all others in whole cells from the laser. Nothing where scans cannot be told so: poses that are
/// not finite or beyond 1000 km, no scans or one of more than 65,536 beams, far more beams than
/// their bytes may tell, scans that stay closer than 10 ms to each other, cells below 5 mm or above
/// a metre. O(cells on all beams), a few microseconds each.
[[nodiscard]] std::optional<CodedVisit> code_visit(std::span<const PosedScan> scans,
                                                   const ReflectionGrid& map,
                                                   const std::string& map_hash, double tolerance_m);

/// The hash of the map that those bytes are relative to. Throws DamageError at `place`.
[[nodiscard]] std::string map_of_coded_visit(std::span<const std::byte> bytes,
                                             const std::string& place);

/// The scans, as of run `run`: the same bits on every machine. Requires the map of that hash; of
/// another one it gives other scans, or throws. Throws DamageError at `place`.
[[nodiscard]] std::vector<PosedScan> scans_of_coded_visit(std::span<const std::byte> bytes,
                                                          const ReflectionGrid& map, int run,
                                                          const std::string& place);

}  // namespace strata::memory
