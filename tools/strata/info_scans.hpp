// SPDX-License-Identifier: Apache-2.0
/// What `strata info` tells of the scans of a log, and of each scanner of several.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/log_reader.hpp"
#include "core/scan/scan.hpp"

namespace strata::tools {

/// A number as `format`, which is that of one double for printf, says.
[[nodiscard]] std::string number(double value, const char* format);

struct ScannerOfLog {
  std::string topic;  ///< "/a, /b" for two that sit at one place, which count as one
  std::vector<Observation> observations;
};

/// The observations of each scanner that has any, in the order of `scanners`, told apart by their
/// mountings; none where there is one scanner only. O(observations x scanners).
[[nodiscard]] std::vector<ScannerOfLog> scanners_of(const std::vector<Observation>& observations,
                                                    const std::vector<log::ReadScanner>& scanners);

/// Counts, rate, geometry, limits, mounting of scans, of which there is at least one; angles in
/// degrees, lengths in metres. Geometry and mounting are the first one's.
[[nodiscard]] nlohmann::ordered_json describe_scans(const std::vector<Observation>& observations,
                                                    double duration_s);

/// Of what describe_scans gives: "181 over 180.0 deg from -90.00 deg, 0.05 to 20.00 m".
[[nodiscard]] std::string beams_of(const nlohmann::ordered_json& scans);
/// ... and "0.100 m, 0.000 m, 0.0000 rad".
[[nodiscard]] std::string mounting_of(const nlohmann::ordered_json& scans);
/// Two lines on stdout for one scanner of several.
void print_scanner(const nlohmann::ordered_json& scanner);

}  // namespace strata::tools
