// SPDX-License-Identifier: Apache-2.0
#include "core/scan/no_return.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "core/scan/range_limit.hpp"

namespace strata {
namespace {

constexpr double kBinM = 0.01;  // what scanners and log formats resolve
constexpr std::size_t kBinsAMetre = 100;
constexpr std::size_t kFurthestBins = 15;  // scatter, either way
constexpr std::size_t kWidestGapBins = 5;
constexpr std::size_t kLeastReadings = 20;
constexpr double kLeastShare = 0.0005;
constexpr double kTimesDenser = 10.0;
constexpr double kShareAbove = 0.02;
constexpr std::size_t kMostCodes = 2;
constexpr double kPlaceM = 0.5;
constexpr std::size_t kLeastPlaces = 3;
constexpr double kLeastShareOfBeams = 0.15;
constexpr double kLeastBeams = 5.0;  // of a scanner with few
constexpr double kLeastBeamsAReading = 0.25;
constexpr std::size_t kSectors = 16;
constexpr std::size_t kLeastSectors = 8;

std::size_t bin_of(float range_m) {
  return static_cast<std::size_t>(std::lround(static_cast<double>(range_m) / kBinM));
}

using Place = std::pair<std::int64_t, std::int64_t>;
Place place_of(const Pose2& pose) {
  const auto cell = [](double value_m) {
    return static_cast<std::int64_t>(std::floor(std::clamp(value_m / kPlaceM, -1e15, 1e15)));
  };
  return {cell(pose.x), cell(pose.y)};
}

std::size_t sector_of(double direction_rad) {
  const double turns = direction_rad / (2.0 * std::numbers::pi);
  const double share = turns - std::floor(turns);  // NaN where there is no direction
  return share < 1.0 ? static_cast<std::size_t>(share * static_cast<double>(kSectors)) : 0;
}

/// How many readings there are a centimetre.
class Histogram {
 public:
  explicit Histogram(std::span<const PlacedScan> scans) : counts_(bin_of(kLongestRangeM) + 1, 0) {
    for (const PlacedScan& placed : scans) {
      const Scan& scan = *placed.scan;
      for (std::size_t beam = 0; beam < scan.size(); ++beam) {
        if (scan.kind(beam) != BeamKind::kHit || scan.ranges_m[beam] <= 1.0F) continue;
        ++counts_[bin_of(scan.ranges_m[beam])];
        ++readings_;
      }
    }
    while (!counts_.empty() && counts_.back() == 0) counts_.pop_back();
  }
  [[nodiscard]] std::size_t readings() const { return readings_; }
  /// Behind the last bin that has any.
  [[nodiscard]] std::size_t end() const { return counts_.size(); }
  [[nodiscard]] std::size_t at(std::size_t bin) const { return counts_[bin]; }
  /// In [from, to).
  [[nodiscard]] std::size_t within(std::size_t from, std::size_t to) const {
    std::size_t sum = 0;
    for (std::size_t bin = from; bin < std::min(to, end()); ++bin) sum += counts_[bin];
    return sum;
  }

 private:
  std::vector<std::size_t> counts_;
  std::size_t readings_ = 0;
};

struct Pile {
  std::size_t from = 0;  ///< bins, both within
  std::size_t to = 0;
  std::size_t readings = 0;
  double expected = 0.0;  ///< as many as there would be if it were as dense as what lies below
};

/// Readings a bin in the metre below a bin: the median of its decimetres, so that another code
/// there is not taken for walls.
double density_of_metre_below(const Histogram& readings, std::size_t bin) {
  constexpr std::size_t kParts = 10;
  constexpr std::size_t kBins = kBinsAMetre / kParts;
  std::array<std::size_t, kParts> parts{};
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t end = bin - std::min(bin, part * kBins);
    parts[part] = readings.within(end - std::min(end, kBins), end);
  }
  std::nth_element(parts.begin(), parts.begin() + kParts / 2, parts.end());
  return static_cast<double>(parts[kParts / 2]) / static_cast<double>(kBins);
}

/// Of the 25 cm below.
double density_right_below(const Histogram& readings, std::size_t bin) {
  constexpr std::size_t kBins = kBinsAMetre / 4;
  return static_cast<double>(readings.within(bin - std::min(bin, kBins), bin)) /
         static_cast<double>(kBins);
}

/// The pile around a bin, with its scatter.
Pile pile_around(const Histogram& readings, std::size_t peak, std::size_t end) {
  const double background = density_of_metre_below(readings, peak - 2 * kFurthestBins);
  const auto is_scatter = [&](std::size_t bin) {
    return readings.at(bin) > 0 && static_cast<double>(readings.at(bin)) >= 4.0 * background;
  };
  Pile pile{peak, peak, 0, 0.0};
  for (std::size_t bin = peak; bin-- > peak - kFurthestBins && pile.from - bin <= kWidestGapBins;) {
    if (is_scatter(bin)) pile.from = bin;
  }
  for (std::size_t bin = peak + 1;
       bin < std::min(end, peak + kFurthestBins + 1) && bin - pile.to <= kWidestGapBins; ++bin) {
    if (is_scatter(bin)) pile.to = bin;
  }
  pile.readings = readings.within(pile.from, pile.to + 1);
  const double width = static_cast<double>(std::max<std::size_t>(3, pile.to - pile.from + 1));
  pile.expected = width * std::max(background, density_right_below(readings, pile.from));
  return pile;
}

bool stands_out(const Pile& pile, std::size_t all_readings, std::size_t above) {
  const auto count = static_cast<double>(pile.readings);
  return pile.readings >= kLeastReadings &&
         count >= kLeastShare * static_cast<double>(all_readings) &&
         count >= kTimesDenser * pile.expected &&
         static_cast<double>(above) <= 2.0 + kShareAbove * count;
}

/// Whether it is seen from where the robot is and in what direction ever.
bool is_seen_everywhere(const Pile& pile, std::span<const PlacedScan> scans) {
  std::set<Place> places;
  std::map<Place, std::size_t> seen_from;
  std::set<std::size_t> seen_in;  ///< beams
  std::set<std::size_t> sectors;  ///< of the world's directions
  std::size_t beams = 0;
  for (const PlacedScan& placed : scans) {
    const Scan& scan = *placed.scan;
    const Place place = place_of(placed.odom_from_robot);
    places.insert(place);
    beams = std::max(beams, scan.size());
    for (std::size_t beam = 0; beam < scan.size(); ++beam) {
      if (scan.kind(beam) != BeamKind::kHit) continue;
      const std::size_t bin = bin_of(scan.ranges_m[beam]);
      if (bin < pile.from || bin > pile.to) continue;
      ++seen_from[place];
      seen_in.insert(beam);
      sectors.insert(sector_of(placed.odom_from_robot.theta + scan.bearing_rad(beam)));
    }
  }
  const double least_beams =
      std::min(std::max(kLeastBeams, kLeastShareOfBeams * static_cast<double>(beams)),
               kLeastBeamsAReading * static_cast<double>(pile.readings));
  const bool is_all_round = sectors.size() >= kLeastSectors;
  if (static_cast<double>(seen_in.size()) < least_beams && !is_all_round) return false;
  if (places.size() < kLeastPlaces) return true;
  std::size_t most = 0;
  for (const auto& [place, count] : seen_from) most = std::max(most, count);
  const std::size_t elsewhere = pile.readings - most;
  return seen_from.size() >= kLeastPlaces && elsewhere >= kLeastReadings &&
         static_cast<double>(elsewhere) >= kTimesDenser * pile.expected;
}

NoReturnCode code_of(const Pile& pile, std::span<const PlacedScan> scans) {
  NoReturnCode code{kLongestRangeM, 0.0F, pile.readings, 0};
  for (const PlacedScan& placed : scans) {
    const Scan& scan = *placed.scan;
    for (std::size_t beam = 0; beam < scan.size(); ++beam) {
      const float range_m = scan.ranges_m[beam];
      if (scan.kind(beam) != BeamKind::kHit) continue;
      if (bin_of(range_m) < pile.from || bin_of(range_m) > pile.to) continue;
      code.from_m = std::min(code.from_m, range_m);
      code.to_m = std::max(code.to_m, range_m);
    }
  }
  return code;
}

/// The highest pile below `end`.
std::optional<Pile> find_pile(const Histogram& readings, std::span<const PlacedScan> scans,
                              std::size_t end) {
  const auto all = static_cast<double>(readings.readings());
  constexpr std::size_t kLeastInABin = 5;
  std::size_t above = 0;
  for (std::size_t bin = end; bin-- > kBinsAMetre;) {
    // With more than that above it none can be a pile.
    if (static_cast<double>(above) > 2.0 + kShareAbove * all) return std::nullopt;
    above += readings.at(bin);
    if (readings.at(bin) < kLeastInABin) continue;
    const Pile pile = pile_around(readings, bin, end);
    if (stands_out(pile, readings.readings(), readings.within(pile.to + 1, end)) &&
        is_seen_everywhere(pile, scans)) {
      return pile;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<NoReturnCode> find_no_return_codes(std::span<const PlacedScan> scans) {
  const Histogram readings(scans);
  std::vector<NoReturnCode> codes;
  std::size_t end = readings.end();
  while (codes.size() < kMostCodes) {
    const auto pile = find_pile(readings, scans, end);
    if (!pile) break;
    const std::size_t metre = pile->from > kBinsAMetre ? pile->from - kBinsAMetre : 0;
    codes.push_back(code_of(*pile, scans));
    codes.back().below = readings.within(metre, pile->from);
    end = pile->from;
  }
  return codes;
}

void set_range_limit(Scan& scan, float limit_m) {
  scan.range_max_m = limit_m;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) == BeamKind::kNoReturn) {
      scan.ranges_m[beam] = std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace strata
