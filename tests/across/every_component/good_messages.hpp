// SPDX-License-Identifier: Apache-2.0
/// What a robot in a room of 6 by 4 metres publishes, of every type that components read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/grid/reflection_grid.hpp"

namespace strata::test {

/// The room as a map, 0.05 m a cell.
[[nodiscard]] ReflectionGrid room_map();
/// A drive through it, written into `folder` at the first call.
[[nodiscard]] std::filesystem::path written_log(const std::filesystem::path& folder);

/// A message of the drive: a scan, odometry, map, transform, ... of that moment, as CDR bytes. For
/// a type that is not known here, one whose numbers are 0, whose strings are short and whose
/// sequences have two elements, by its IDL. step: counted from 0, 0.1 s each.
[[nodiscard]] std::vector<std::uint8_t> good_message(const std::string& type,
                                                     const std::string& topic, int step);

}  // namespace strata::test
