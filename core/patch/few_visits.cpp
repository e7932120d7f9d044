// SPDX-License-Identifier: Apache-2.0
// The contradiction test that pools over space (docs/theory/patch_maps.md, "Few visits").
#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/grid/connected_cells.hpp"
#include "core/patch/contradiction.hpp"
#include "core/patch/jitter.hpp"
#include "core/patch/surface_spread.hpp"

namespace strata::patch {
namespace {

using VisitPair = std::pair<Visit, Visit>;  // occupied in the first, free in the second

/// The evidence of a pair of visits, in beams.
struct Strength {
  double hits = 0.0;    ///< ends in the visit that found the cell occupied
  double across = 0.0;  ///< of the other: what went across the surface
};

class FewVisitsTest {
 public:
  FewVisitsTest(const VisitTable& table, const ContradictionConfig& config)
      : table_(table),
        config_(config),
        around_(disc_offsets(config.tolerance_m, table.resolution_m())),
        candidates_(table.resolution_m(), table.rect(), 0) {}

  Grid<std::uint8_t> run() {
    Grid<std::uint8_t> mask(table_.resolution_m(), table_.rect(), 0);
    for (const Cell& cell : table_.cells()) {
      if (has_pair(cell)) candidates_.at(cell) = 1;
    }
    for_each_component(candidates_, CellLink::kOverAGap,
                       [&](const std::vector<Cell>& component) { mark_coherent(component, mask); });
    return mask;
  }

 private:
  [[nodiscard]] bool is_occupied_in(const Visit& visit) const {
    return visit.total() >= config_.few_min_beams &&
           static_cast<double>(visit.hits) >= config_.few_occupied_share * visit.total();
  }
  /// Free, and nothing near was hit meanwhile: else it may be the same surface, displaced by the
  /// error of the poses.
  [[nodiscard]] bool is_free_in(const Cell& cell, const Visit& visit) const {
    if (visit.total() < config_.few_min_beams) return false;
    if (static_cast<double>(visit.hits) > config_.few_free_share * visit.total()) return false;
    return !was_hit_nearby(table_, cell, visit, around_, config_.few_free_share);
  }
  /// All pairs of an occupied and a free visit of the cell.
  void find_pairs(const Cell& cell, std::vector<VisitPair>& pairs) const {
    pairs.clear();
    const auto visits = table_.at(cell);
    if (visits.size() < 2 || visits.size() > static_cast<std::size_t>(config_.few_max_visits)) {
      return;
    }
    if (std::none_of(visits.begin(), visits.end(),
                     [&](const Visit& v) { return is_occupied_in(v); })) {
      return;
    }
    for (const Visit& free : visits) {
      if (!is_free_in(cell, free)) continue;
      for (const Visit& occupied : visits) {
        if (is_occupied_in(occupied)) pairs.emplace_back(occupied, free);
      }
    }
  }
  [[nodiscard]] bool has_pair(const Cell& cell) {
    find_pairs(cell, pairs_);
    return !pairs_.empty();
  }
  [[nodiscard]] bool is_large(const std::vector<Cell>& cells) const {
    return reaches(cells, config_.few_min_cells, config_.few_min_extent_m);
  }
  [[nodiscard]] bool is_large_if_strong(const std::vector<Cell>& cells) const {
    return reaches(cells, config_.few_strong_cells, config_.few_strong_extent_m);
  }
  [[nodiscard]] bool reaches(const std::vector<Cell>& cells, int least, double extent_m) const {
    if (cells.size() < static_cast<std::size_t>(least)) return false;
    return SurfaceSpread(cells).extent(cells) * table_.resolution_m() >= extent_m - 1e-9;
  }
  /// Marks the cells of a component that agree on when it was occupied and when it was free: for
  /// some pair of visits enough of them support the same pair, or fewer by strong evidence.
  /// Cells of walls that jitter back and forth make components whose cells disagree. What was
  /// occupied then is the surface that the beams of the free visit must have gone across.
  /// O(cells^2 pairs^2) of the component.
  void mark_coherent(const std::vector<Cell>& component, Grid<std::uint8_t>& mask) const {
    if (!is_large(component) && !is_large_if_strong(component)) return;
    std::vector<std::vector<VisitPair>> pairs(component.size());
    for (std::size_t i = 0; i < component.size(); ++i) find_pairs(component[i], pairs[i]);
    std::vector<Cell> cells;
    for (const auto& candidates : pairs) {
      for (const VisitPair& wanted : candidates) {
        cells.clear();
        for (std::size_t k = 0; k < component.size(); ++k) {
          if (supports(pairs[k], wanted)) cells.push_back(component[k]);
        }
        if (!is_large(cells) && !is_large_if_strong(cells)) continue;
        const SurfaceSpread surface(cells);
        Strength sum;
        cells.clear();
        for (std::size_t k = 0; k < component.size(); ++k) {
          const std::optional<Strength> strength = strength_of(pairs[k], wanted, surface);
          if (!strength) continue;
          cells.push_back(component[k]);
          sum = {sum.hits + strength->hits, sum.across + strength->across};
        }
        const double strong = config_.few_strong_beams * static_cast<double>(cells.size());
        const bool is_strong = std::min(sum.hits, sum.across) >= strong;
        if (is_strong && is_large_if_strong(cells)) {
          mark(cells, kStronglyContradictory, mask);
        } else if (is_large(cells)) {
          mark(cells, kContradictory, mask);
        }
      }
    }
  }
  static void mark(const std::vector<Cell>& cells, std::uint8_t value, Grid<std::uint8_t>& mask) {
    for (const Cell& cell : cells) mask.at(cell) = std::max(mask.at(cell), value);
  }
  [[nodiscard]] static bool is_same(const VisitPair& pair, const VisitPair& wanted) {
    return pair.first.overlaps(wanted.first) && pair.second.overlaps(wanted.second);
  }
  [[nodiscard]] static bool supports(const std::vector<VisitPair>& pairs, const VisitPair& wanted) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const VisitPair& pair) { return is_same(pair, wanted); });
  }
  /// The most that a pair of a cell, which supports the wanted one and is free by beams across the
  /// surface, has of each; nothing when there is no such pair.
  [[nodiscard]] std::optional<Strength> strength_of(const std::vector<VisitPair>& pairs,
                                                    const VisitPair& wanted,
                                                    const SurfaceSpread& surface) const {
    std::optional<Strength> most;
    for (const VisitPair& pair : pairs) {
      if (!is_same(pair, wanted)) continue;
      if (!surface.is_crossed_by(pair.second, config_.min_across)) continue;
      const Strength before = most.value_or(Strength{});
      most = {std::max(before.hits, static_cast<double>(pair.first.hits)),
              std::max(before.across, surface.misses_across(pair.second))};
    }
    return most;
  }

  const VisitTable& table_;
  const ContradictionConfig& config_;
  std::vector<Cell> around_;
  Grid<std::uint8_t> candidates_;
  std::vector<VisitPair> pairs_;
};

}  // namespace

Grid<std::uint8_t> test_few_visits(const VisitTable& table, const ContradictionConfig& config) {
  return FewVisitsTest(table, config).run();
}

}  // namespace strata::patch
