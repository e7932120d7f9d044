// SPDX-License-Identifier: Apache-2.0
#include "core/patch/jitter.hpp"

#include <algorithm>
#include <cmath>

#include "core/grid/connected_cells.hpp"
#include "core/grid/disc.hpp"

namespace strata::patch {
namespace {

bool is_free_in(const Visit& visit, const ContradictionConfig& config) {
  return visit.total() >= config.min_evidence &&
         static_cast<double>(visit.hits) <= config.few_free_share * visit.total();
}

/// Hit by two visits or more, and by none found free: a wall, whatever else moves.
bool is_permanent(std::span<const Visit> visits, const ContradictionConfig& config) {
  int hit = 0;
  for (const Visit& visit : visits) {
    if (is_free_in(visit, config)) return false;
    if (static_cast<double>(visit.hits) > 0.5) ++hit;
  }
  return hit >= 2;
}

bool is_permanent_nearby(const VisitTable& table, const Cell& cell, std::span<const Cell> offsets,
                         const ContradictionConfig& config) {
  return std::any_of(offsets.begin(), offsets.end(), [&](const Cell& offset) {
    return is_permanent(table.at({cell.x + offset.x, cell.y + offset.y}), config);
  });
}

/// Whether the visit was cut by a change in view: another follows on it, or it on another, within a
/// third of its length in scans. (A visit that was cut is at least three gaps long.)
bool borders_on_change(std::span<const Visit> visits, const Visit& visit) {
  const std::uint32_t third = (visit.last_scan - visit.first_scan) / 3;
  return std::any_of(visits.begin(), visits.end(), [&](const Visit& other) {
    return other.first_scan > visit.last_scan
               ? other.first_scan - visit.last_scan <= third
               : other.last_scan < visit.first_scan && visit.first_scan - other.last_scan <= third;
  });
}

}  // namespace

std::vector<Cell> disc_offsets(double radius_m, double resolution_m) {
  std::vector<Cell> offsets = disc(std::max(radius_m, 1.5 * resolution_m), resolution_m);
  std::erase(offsets, Cell{0, 0});
  return offsets;
}

bool was_hit_nearby(const VisitTable& table, const Cell& cell, const Visit& visit,
                    std::span<const Cell> offsets, double free_share) {
  const double share = borders_on_change(table.at(cell), visit) ? free_share : 0.0;
  for (const Cell& offset : offsets) {
    const auto others = table.at({cell.x + offset.x, cell.y + offset.y});
    auto other = std::partition_point(others.begin(), others.end(), [&](const Visit& v) {
      return v.last_scan < visit.first_scan;
    });
    for (; other != others.end() && other->overlaps(visit); ++other) {
      if (static_cast<double>(other->hits) > std::max(0.5, share * other->total())) return true;
    }
  }
  return false;
}

void drop_displaced_surfaces(const VisitTable& table, const ContradictionConfig& config,
                             Grid<std::uint8_t>& mask) {
  const std::vector<Cell> around = disc_offsets(config.displaced_reach_m, table.resolution_m());
  const std::vector<Cell> same = disc_offsets(config.tolerance_m, table.resolution_m());
  for_each_component(mask, CellLink::kOverAGap, [&](const std::vector<Cell>& component) {
    std::size_t free = 0;
    std::size_t near = 0;
    std::size_t beside = 0;
    for (const Cell& cell : component) {
      if (is_permanent_nearby(table, cell, around, config)) ++beside;
      for (const Visit& visit : table.at(cell)) {
        // A hit within the tolerance made the visit no evidence for the change: nor is it against.
        if (!is_free_in(visit, config) ||
            was_hit_nearby(table, cell, visit, same, config.few_free_share))
          continue;
        ++free;
        if (was_hit_nearby(table, cell, visit, around, config.few_free_share)) ++near;
      }
    }
    if (static_cast<double>(near) < config.max_displaced_share * static_cast<double>(free) &&
        static_cast<double>(beside) <
            config.max_displaced_share * static_cast<double>(component.size())) {
      return;
    }
    for (const Cell& cell : component) mask.at(cell) = 0;
  });
}

}  // namespace strata::patch
