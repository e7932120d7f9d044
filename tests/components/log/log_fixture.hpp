// SPDX-License-Identifier: Apache-2.0
/// Small logs to write, damage and read again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log::test_log {

using strata::test::bytes_of;

/// Seeded scans of `beams` beams with hits, no-returns and odometry on a curve; odometry samples
/// lie between the scans.
[[nodiscard]] LogContent make_log(std::size_t scans, std::size_t beams, std::uint64_t seed);

/// All of a bag: its messages, and what was told of it.
struct BagContent {
  std::vector<std::pair<std::int64_t, std::vector<std::uint8_t>>> messages;  ///< with their ns
  std::vector<BagTopic> topics;
  BagDamage damage;
  std::string description;

  [[nodiscard]] std::vector<std::int64_t> stamps() const;
};
[[nodiscard]] BagContent read_bag(const std::filesystem::path& path);

void write_text(const std::filesystem::path& path, const std::string& text);

/// Whether two floats are the same number: equal bits, or both NaN.
[[nodiscard]] bool same_bits(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace strata::log::test_log
