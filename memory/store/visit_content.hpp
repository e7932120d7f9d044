// SPDX-License-Identifier: Apache-2.0
/// A visit as bytes that go from one machine to another: its scans with their poses, from which
/// learning goes on elsewhere as it would where it was driven (Slam::add_placed and all that
/// follows read no more of a scan). Beam labels are left out: learning makes them anew.
///
/// The same scans give the same bytes anywhere, so that their hash names the visit; how they are
/// packed may differ between versions of zstd. docs/fleet.md, "What a visit is", has the layout.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata::memory {

/// Of the layout; kept beside a content, which does not say it.
inline constexpr int kVisitFormat = 1;

/// Requires scans in order of time. Ranges that are whole centimetres or millimetres take two bytes
/// or less, as their steps from beam to beam. Bit for bit, but that every NaN is one. O(beams).
[[nodiscard]] std::vector<std::byte> visit_content(std::span<const PosedScan> scans);

/// The scans of a content, as of run `run`. Throws DamageError at `place`. O(beams).
[[nodiscard]] std::vector<PosedScan> scans_of_visit(std::span<const std::byte> content, int run,
                                                    const std::string& place);

/// A zstd frame with a checksum, as small as zstd makes it in reasonable time.
[[nodiscard]] std::vector<std::byte> pack_visit(std::span<const std::byte> content);
/// Throws DamageError at `place`.
[[nodiscard]] std::vector<std::byte> unpack_visit(std::span<const std::byte> packed,
                                                  const std::string& place);

}  // namespace strata::memory
