// SPDX-License-Identifier: Apache-2.0
/// Whose turn it is where of the scans of one place only one is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// A robot's scanners are told apart by their mountings. Scans are gated by motion: of two scanners
/// that turn in step only the first would ever pass. With turns the one that was used least lately
/// does, and the others pass it the gate once. With one scanner it is always its turn.
class ScannerTurns {
 public:
  /// Every scan, used or not; another run begins anew. O(scanners).
  void see(const Scan& scan, int run = 0);
  /// The scan that was seen last passed the gate: whether it is to be used. When not, some other
  /// scanner's next one is; the same scanner is not sent away twice.
  [[nodiscard]] bool has_turn();
  /// The scan that was seen last is used.
  void use();
  /// Scanners that sent one of the last scans; at least 1.
  [[nodiscard]] std::size_t alive() const;

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.scanners_);
    archive(self.seen_);
    archive(self.newest_);
    archive(self.run_);
  }

 private:
  struct Scanner {
    Pose2 robot_from_laser;
    std::uint64_t seen = 0;  ///< when, in scans
    std::uint64_t used = 0;
    std::uint64_t passed = 0;  ///< 1: since some scan was used
  };
  [[nodiscard]] bool is_alive(const Scanner& scanner) const;
  std::vector<Scanner> scanners_;
  std::uint64_t seen_ = 0;
  std::uint64_t newest_ = 0;  ///< of whom the last scan was
  int run_ = 0;
};

}  // namespace strata
