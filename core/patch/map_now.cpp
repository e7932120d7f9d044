// SPDX-License-Identifier: Apache-2.0
#include "core/patch/map_now.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/grid/disc.hpp"

namespace strata::patch {
namespace {

constexpr double kMoreThanNot = 0.5;

double sum_of(std::uint64_t configurations, const Shares& shares) {
  double sum = 0.0;
  for (std::uint64_t left = configurations; left != 0; left &= left - 1) {
    sum += shares[static_cast<std::size_t>(std::countr_zero(left))];
  }
  return sum;
}

/// P(occupied | a configuration that knows). 0 / 0: half.
double share_of(std::uint64_t occupied, std::uint64_t known, const Shares& shares) {
  const double all = sum_of(known, shares);
  return all > 0.0 ? std::min(1.0, sum_of(occupied, shares) / all) : kMoreThanNot;
}

}  // namespace

double change_probability(double now, double usual, double rate_per_s, double horizon_s) {
  const bool is_likelier = now >= kMoreThanNot;
  const double held = std::clamp(is_likelier ? now : 1.0 - now, 0.0, 1.0);
  const double usually = std::clamp(is_likelier ? usual : 1.0 - usual, 0.0, 1.0);
  return 1.0 - held * std::exp(-rate_per_s * (1.0 - usually) * horizon_s);
}

MapNow::MapNow(const PatchMap& map) {
  base_ = compose(map, std::vector<int>(map.submaps.size(), -1));
  for (float& value : base_.values()) {
    if (is_known(value)) value = is_occupied(value) ? 1.0F : 0.0F;
  }
  for (const Submap& submap : map.submaps) {
    configurations_.push_back(submap.configurations.size());
  }
  Grid<std::uint8_t> is_taken(base_.resolution_m(), base_.rect(), 0);
  for (const Submap& submap : map.submaps) {
    const CellRect& rect = submap.rect;
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      for (int x = rect.min.x; x < rect.max.x; ++x) {
        const Cell cell{x, y};
        if (is_taken.at(cell) != 0) continue;
        is_taken.at(cell) = 1;
        AreaCell area{base_.index(cell), submaps_at(map, cell).front(), 0, 0};
        for (std::size_t k = 0; k < configurations_[area.submap]; ++k) {
          const float m = reflection_at(map, area.submap, k, cell);
          if (is_known(m)) area.known |= std::uint64_t{1} << k;
          if (is_occupied(m)) area.occupied |= std::uint64_t{1} << k;
        }
        cells_.push_back(area);
      }
    }
  }
}

ReflectionGrid MapNow::occupied(std::span<const Shares> beliefs) const {
  ReflectionGrid result = base_;
  for (const AreaCell& cell : cells_) {
    const Shares& belief = beliefs[cell.submap];
    result.values()[cell.place] =
        sum_of(cell.known, belief) < kMoreThanNot
            ? kUnknownReflection
            : static_cast<float>(share_of(cell.occupied, cell.known, belief));
  }
  return result;
}

Grid<float> MapNow::change(std::span<const SubmapOutlook> outlook, double horizon_s,
                           double reach_m) const {
  Grid<float> result(base_.resolution_m(), base_.rect(), 0.0F);
  const std::vector<Cell> reach = disc(std::max(0.0, reach_m), base_.resolution_m());
  for (const AreaCell& area : cells_) {
    if (area.occupied == 0 || area.occupied == area.known) continue;
    const SubmapOutlook& here = outlook[area.submap];
    const auto probability = static_cast<float>(change_probability(
        share_of(area.occupied, area.known, here.now),
        share_of(area.occupied, area.known, here.usual), here.rate_per_s, horizon_s));
    const Cell middle = result.cell(area.place);
    for (const Cell& offset : reach) {
      const Cell cell{middle.x + offset.x, middle.y + offset.y};
      if (!result.contains(cell)) continue;
      result.at(cell) = std::max(result.at(cell), probability);
    }
  }
  return result;
}

}  // namespace strata::patch
