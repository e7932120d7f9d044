// SPDX-License-Identifier: Apache-2.0
/// Small logs for tests of the program.
#pragma once

#include <filesystem>
#include <fstream>

namespace strata::test {

/// A CARMEN log, a scan of four beams a second; one of them saw nothing.
inline void write_log(const std::filesystem::path& path, int scans) {
  std::ofstream out(path);
  for (int i = 0; i < scans; ++i) {
    out << "ODOM " << 0.1 * i << " 0 0 0 0 0 " << i << ".5 h 0\n";
    out << "FLASER 4 1 2 3 81.83 " << 0.1 * i + 0.2 << " 0 0 " << 0.1 * i << " 0 0 " << i
        << ".75 h 0\n";
  }
}

/// A bag of ROS 1 with three scans.
inline std::filesystem::path ros1_bag() {
  return std::filesystem::path(STRATA_SOURCE_DIR) / "tests/fuzz/corpus/bag/ros1_lz4.bag";
}

}  // namespace strata::test
