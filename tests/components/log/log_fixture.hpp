// SPDX-License-Identifier: Apache-2.0
/// Small logs to write, damage and read again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "components/log/log_reader.hpp"

namespace strata::log::test {

/// Seeded scans of `beams` beams with hits, no-returns and odometry on a curve; odometry samples
/// lie between the scans.
[[nodiscard]] LogContent make_log(std::size_t scans, std::size_t beams, std::uint64_t seed);

[[nodiscard]] std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

/// Whether two floats are the same number: equal bits, or both NaN.
[[nodiscard]] bool same_bits(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace strata::log::test
