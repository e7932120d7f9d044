// SPDX-License-Identifier: Apache-2.0
/// Everything of a scan but its ranges and labels, as the store and visits keep it.
#pragma once

#include <cstdint>

#include "core/scan/scan.hpp"

namespace strata::memory::detail {

/// No padding: it goes out as it lies in memory.
struct ScanHeader {
  std::int64_t stamp_ns;
  double map_from_robot[3];
  double robot_from_laser[3];
  float angle_min_rad;
  float angle_increment_rad;
  float time_increment_s;
  float scan_time_s;
  float range_min_m;
  float range_max_m;
  std::uint32_t ranges;
  std::uint32_t more;  ///< what whoever keeps it has to say besides
};
static_assert(sizeof(ScanHeader) == 88);

[[nodiscard]] ScanHeader header_of(const PosedScan& posed, std::uint32_t more);
/// A scan with as many ranges, all 0, and without labels.
[[nodiscard]] PosedScan scan_of(const ScanHeader& header, int run);

}  // namespace strata::memory::detail
