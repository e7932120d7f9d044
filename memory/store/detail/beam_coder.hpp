// SPDX-License-Identifier: Apache-2.0
/// The ranges of a visit's scans relative to a map: most beams end where the map says, and cost
/// next to nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "memory/store/detail/bit_coder.hpp"
#include "memory/store/detail/live_map.hpp"

namespace strata::memory::detail {

class BeamCoder {
 public:
  /// tolerance_m: who writes takes the map's range for a beam that lies so close to it, or between
  /// the map's ranges for the beams beside it. Who reads need not know it.
  BeamCoder(BitCoder& bits, const ReflectionGrid& map, double tolerance_m);

  /// Codes the ranges of a scan at its pose; afterwards they are what is read. Requires finite
  /// poses within 1000 km.
  void code(PosedScan& posed);

 private:
  /// How a beam is told.
  enum class Told : std::uint8_t {
    kFirst,     ///< it ends at the first surface, or nothing was expected or came back
    kSecond,    ///< ... at the one behind
    kNoReturn,  ///< nothing came back, though something stands there
    kSaysNothing,
    kTooClose,
    kValue,
  };
  static constexpr std::uint32_t kTold = 6;
  /// What the beams before say of the next one.
  struct Before {
    std::uint32_t last = 0;
    std::uint32_t second_last = 0;
    int values = 0;  ///< told by value, in a row; 2 stands for more
    std::int64_t last_value = 0;
    std::int64_t second_last_value = 0;
  };
  struct Wish;

  void set_limits(const Scan& scan);
  void look(const PosedScan& posed);
  [[nodiscard]] bool fits(const Wish& wish, std::size_t beam, int RayAhead::*surface_cm) const;
  Told code_told(const PosedScan& posed, std::size_t beam, const Wish& wish, const Before& before);
  std::int64_t code_value(std::size_t beam, std::int64_t wish, const Before& before);
  [[nodiscard]] std::uint32_t told_there_before(const PosedScan& posed, std::size_t beam) const;
  [[nodiscard]] std::int64_t value_of(const Wish& wish) const;
  void remember(const PosedScan& posed, const std::vector<Told>& told,
                const std::vector<int>& range_cm);

  BitCoder& bits_;
  LiveMap map_;
  double tolerance_cm_;
  int step_cm_;
  BitModel first_, second_, no_return_, says_nothing_, too_close_, shorter_, goes_on_;
  NumberModel change_, jump_;
  // Of the scan.
  std::vector<Ray> rays_;
  std::vector<RayAhead> ahead_;
  int least_cm_ = 0;
  int most_cm_ = 0;
  std::int64_t least_value_ = 1;
  std::int64_t most_value_ = 0;
  // Of the one before.
  std::vector<Told> told_before_;
  double heading_before_rad_ = 0.0;
};

}  // namespace strata::memory::detail
