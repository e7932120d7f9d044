// SPDX-License-Identifier: Apache-2.0
/// How much room a store takes on the disk.
#pragma once

#include <cstdint>
#include <filesystem>

namespace strata::log {

/// Of a file, with those that SQLite keeps beside it, or of all files in a folder; 0 where there is
/// nothing or it cannot be asked. Never throws. O(files).
[[nodiscard]] std::uint64_t stored_bytes(const std::filesystem::path& store) noexcept;

}  // namespace strata::log
