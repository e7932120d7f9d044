// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/change_candidates.hpp"

#include <algorithm>
#include <span>

#include "core/grid/connected_cells.hpp"

namespace strata::pipeline {
namespace {

constexpr std::size_t kMinChangedCells = 4;
/// An old state: this share of the changed cells that an earlier visit knows were as they are now.
constexpr double kSameState = 0.8;

CellState state_of(double hits, double misses, const patch::ContradictionConfig& config) {
  const double total = hits + misses;
  if (total < config.few_min_beams) return CellState::kUnknown;
  if (hits >= static_cast<double>(kMostlyOccupied) * total) return CellState::kOccupied;
  return hits <= config.few_free_share * total ? CellState::kFree : CellState::kUnknown;
}

/// One stay of the robot near a place, and what it saw of each cell.
struct PlaceVisit {
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;
  std::vector<CellState> cells;
};

/// Visits of single cells that share time are one visit of the place. O(v log v + v cells).
std::vector<PlaceVisit> visits_of_place(const std::vector<Cell>& cells,
                                        const patch::VisitTable& table,
                                        const patch::ContradictionConfig& config) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> spans;
  for (const Cell& cell : cells) {
    for (const patch::Visit& visit : table.at(cell)) {
      spans.emplace_back(visit.first_scan, visit.last_scan);
    }
  }
  std::sort(spans.begin(), spans.end());
  std::vector<PlaceVisit> visits;
  for (const auto& [first, last] : spans) {
    if (visits.empty() || first > visits.back().last_scan) {
      visits.push_back({first, last, std::vector<CellState>(cells.size())});
    }
    visits.back().last_scan = std::max<std::size_t>(visits.back().last_scan, last);
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    auto visit = visits.begin();
    double hits = 0.0;
    double misses = 0.0;
    for (const patch::Visit& seen : table.at(cells[c])) {
      while (seen.first_scan > visit->last_scan) {
        ++visit;
        hits = misses = 0.0;
      }
      hits += static_cast<double>(seen.hits);
      misses += static_cast<double>(seen.misses);
      visit->cells[c] = state_of(hits, misses, config);
    }
  }
  return visits;
}

/// `earlier` visits, the last one excluded: did one of them find these cells like this?
bool was_seen_before(std::span<const PlaceVisit> earlier, const std::vector<CellState>& now,
                     const std::vector<std::size_t>& changed) {
  return std::any_of(earlier.begin(), earlier.end(), [&](const PlaceVisit& visit) {
    std::size_t known = 0;
    std::size_t same = 0;
    for (const std::size_t c : changed) {
      if (visit.cells[c] == CellState::kUnknown) continue;
      ++known;
      same += visit.cells[c] == now[c] ? 1 : 0;
    }
    return 2 * known >= changed.size() &&
           static_cast<double>(same) >= kSameState * static_cast<double>(known);
  });
}

void append_changes(const std::vector<Cell>& cells, const std::vector<PlaceVisit>& visits,
                    std::size_t learned_scans, std::vector<ChangeCandidate>& candidates) {
  std::vector<CellState> last(cells.size(), CellState::kUnknown);
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const std::vector<CellState>& now = visits[v].cells;
    std::vector<std::size_t> changed;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (now[c] == CellState::kUnknown) continue;
      if (last[c] != CellState::kUnknown && last[c] != now[c]) changed.push_back(c);
    }
    ChangeCandidate candidate;
    candidate.first_scan = visits[v].first_scan;
    candidate.last_scan = visits[v].last_scan;
    candidate.is_tested =
        visits[v].first_scan >= learned_scans && changed.size() >= kMinChangedCells;
    if (candidate.is_tested) {
      candidate.is_old_state = was_seen_before(std::span(visits).first(v), now, changed);
    }
    // What was learned is pasted too, cell by cell, so that the map before the first event is that
    // of the last look at each place.
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool is_news = last[c] == CellState::kUnknown && now[c] != CellState::kUnknown;
      const bool is_change = std::find(changed.begin(), changed.end(), c) != changed.end();
      if (is_change || (is_news && !candidate.is_tested)) {
        candidate.cells.emplace_back(cells[c], now[c]);
      }
      if (now[c] != CellState::kUnknown) last[c] = now[c];
    }
    if (!candidate.cells.empty()) candidates.push_back(std::move(candidate));
  }
}

/// The last two visits of learning and the first three of the test. A state met once among many
/// visits is noise to the test for many; whether the test part differs from what was there last is
/// a question for the test for few.
patch::VisitTable visits_about_split(const patch::VisitTable& table, double resolution_m,
                                     std::size_t learned_scans) {
  Grid<std::int32_t> slots(resolution_m, table.rect(), -1);
  std::vector<std::uint32_t> offsets{0};
  std::vector<patch::Visit> kept;
  for (const Cell& cell : table.cells()) {
    const auto visits = table.at(cell);
    const auto split = std::find_if(visits.begin(), visits.end(), [&](const patch::Visit& visit) {
      return visit.first_scan >= learned_scans;
    });
    const auto first = split - std::min<std::ptrdiff_t>(2, split - visits.begin());
    const auto last = split + std::min<std::ptrdiff_t>(3, visits.end() - split);
    slots.at(cell) = static_cast<std::int32_t>(offsets.size() - 1);
    kept.insert(kept.end(), first, last);
    offsets.push_back(static_cast<std::uint32_t>(kept.size()));
  }
  return {std::move(slots), std::move(offsets), std::move(kept)};
}

}  // namespace

Grid<std::uint8_t> find_places(const patch::VisitTable& table, double resolution_m,
                               std::size_t learned_scans,
                               const patch::ContradictionConfig& config) {
  Grid<std::uint8_t> places = patch::find_contradictions(table, config);
  const Grid<std::uint8_t> lately =
      patch::find_contradictions(visits_about_split(table, resolution_m, learned_scans), config);
  for (std::size_t i = 0; i < lately.size(); ++i) {
    if (lately.values()[i] != 0) places.at(lately.cell(i)) = 1;
  }
  return places;
}

std::vector<ChangeCandidate> find_candidates(const patch::VisitTable& table,
                                             const Grid<std::uint8_t>& mask,
                                             const patch::ContradictionConfig& config,
                                             std::size_t learned_scans) {
  std::vector<ChangeCandidate> candidates;
  for_each_component(mask, CellLink::kOverAGap, [&](const std::vector<Cell>& cells) {
    append_changes(cells, visits_of_place(cells, table, config), learned_scans, candidates);
  });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const ChangeCandidate& a, const ChangeCandidate& b) {
                     return a.first_scan < b.first_scan;
                   });
  return candidates;
}

}  // namespace strata::pipeline
