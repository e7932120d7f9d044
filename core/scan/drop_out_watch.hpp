// SPDX-License-Identifier: Apache-2.0
/// Which beams without return lost their return, while scans come.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "core/scan/drop_out_tally.hpp"
#include "core/scan/drop_outs.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/scan_state.hpp"
#include "core/scan/scans_around.hpp"

namespace strata {

/// As find_drop_outs, by what was seen until now: the scanner is judged by the scans until then,
/// and a scan's beams without return are told by those of up to 3 s before alone. Memory: 17 scans
/// of each scanner. Not thread-safe.
class DropOutWatch {
 public:
  explicit DropOutWatch(const NoReturnConfig& config = {}) : config_(config) {}

  /// Sets `free_range_m` and `drop_outs` of the next scan. O(beams).
  void take(PosedScan& scan);
  /// What was found until now.
  [[nodiscard]] DropOuts found() const;

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.scanners_);
  }

 private:
  struct Scanner {
    std::deque<PosedScan> recent;  ///< of one scanner, the newest last
    DropOutTally tally;
    std::uint64_t scans = 0;

    template <class Self, class Archive>
    static void state(Self& self, Archive& archive) {
      archive(self.recent);
      archive(self.tally);
      archive(self.scans);
      if constexpr (Archive::kReads) {
        if (self.recent.empty()) archive.fail("has a scanner without scans");
      }
    }
  };
  [[nodiscard]] Scanner& scanner_for(const PosedScan& scan);
  void judge_earlier(Scanner& scanner);

  NoReturnConfig config_;
  std::vector<Scanner> scanners_;
  SurfacesAround before_;
  SurfacesAround after_;
};

}  // namespace strata
