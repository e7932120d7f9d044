// SPDX-License-Identifier: Apache-2.0
// The contradiction test for few visits: pooling over space (SPEC B1, "Few visits").
#include <algorithm>
#include <utility>
#include <vector>

#include "core/patch/contradiction.hpp"
#include "core/patch/jitter.hpp"
#include "core/patch/surface_spread.hpp"

namespace strata::patch {
namespace {

using VisitPair = std::pair<Visit, Visit>;  // occupied in the first, free in the second

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
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (candidates_.values()[i] == 0) continue;
      const std::vector<Cell> component = take_component(candidates_, candidates_.cell(i));
      for (const Cell& cell : coherent_cells(component)) mask.at(cell) = 1;
    }
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
    return !was_hit_nearby(table_, cell, visit, around_);
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
    if (cells.size() < static_cast<std::size_t>(config_.few_min_cells)) return false;
    const double extent_m = SurfaceSpread(cells).extent(cells) * table_.resolution_m();
    return extent_m >= config_.few_min_extent_m - 1e-9;
  }
  /// The cells of a component that agree on when it was occupied and when it was free: for some
  /// pair of visits enough of them support the same pair. Cells of walls that jitter back and forth
  /// make components whose cells disagree. What was occupied then is the surface that the beams of
  /// the free visit must have gone across. O(cells^2 pairs^2) of the component.
  [[nodiscard]] std::vector<Cell> coherent_cells(const std::vector<Cell>& component) const {
    if (!is_large(component)) return {};
    std::vector<std::vector<VisitPair>> pairs(component.size());
    for (std::size_t i = 0; i < component.size(); ++i) find_pairs(component[i], pairs[i]);
    std::vector<std::uint8_t> kept(component.size(), 0);
    std::vector<std::size_t> support;
    std::vector<Cell> cells;
    for (const auto& candidates : pairs) {
      for (const VisitPair& pair : candidates) {
        support.clear();
        cells.clear();
        for (std::size_t k = 0; k < component.size(); ++k) {
          if (!supports(pairs[k], pair)) continue;
          support.push_back(k);
          cells.push_back(component[k]);
        }
        if (!is_large(cells)) continue;
        const SurfaceSpread surface(cells);
        const auto is_grazed = [&](std::size_t k) { return !is_crossed(pairs[k], pair, surface); };
        support.erase(std::remove_if(support.begin(), support.end(), is_grazed), support.end());
        cells.clear();
        for (const std::size_t k : support) cells.push_back(component[k]);
        if (!is_large(cells)) continue;
        for (const std::size_t k : support) kept[k] = 1;
      }
    }
    cells.clear();
    for (std::size_t k = 0; k < component.size(); ++k) {
      if (kept[k] != 0) cells.push_back(component[k]);
    }
    return cells;
  }
  [[nodiscard]] static bool supports(const std::vector<VisitPair>& pairs, const VisitPair& wanted) {
    return std::any_of(pairs.begin(), pairs.end(), [&](const VisitPair& pair) {
      return pair.first.overlaps(wanted.first) && pair.second.overlaps(wanted.second);
    });
  }
  /// Whether a pair of a cell that supports the wanted one is free by beams across the surface.
  [[nodiscard]] bool is_crossed(const std::vector<VisitPair>& pairs, const VisitPair& wanted,
                                const SurfaceSpread& surface) const {
    return std::any_of(pairs.begin(), pairs.end(), [&](const VisitPair& pair) {
      return pair.first.overlaps(wanted.first) && pair.second.overlaps(wanted.second) &&
             surface.is_crossed_by(pair.second, config_.min_across);
    });
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
