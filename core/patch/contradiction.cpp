// SPDX-License-Identifier: Apache-2.0
#include "core/patch/contradiction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/grid/connected_cells.hpp"
#include "core/patch/jitter.hpp"
#include "core/patch/surface_spread.hpp"

namespace strata::patch {
namespace {

VisitEvidence capped(const Visit& visit, double max_evidence) {
  const double total = visit.total();
  const double scale = total > max_evidence ? max_evidence / total : 1.0;
  return {scale * static_cast<double>(visit.hits), scale * static_cast<double>(visit.misses)};
}

double share_of(const VisitEvidence& e) { return e.hits / (e.hits + e.misses); }

/// Of n things, the number of ways to choose m.
double log_choices(std::size_t n, std::size_t m) {
  const auto log_factorial = [](std::size_t k) {
    return std::lgamma(static_cast<double>(k) + 1.0);
  };
  return log_factorial(n) - log_factorial(m) - log_factorial(n - m);
}

}  // namespace

double two_states_tail(std::vector<VisitEvidence>& visits, const ContradictionConfig& config) {
  std::sort(visits.begin(), visits.end(), [](const VisitEvidence& a, const VisitEvidence& b) {
    return share_of(a) > share_of(b);
  });
  VisitEvidence all;
  for (const VisitEvidence& e : visits) all = {all.hits + e.hits, all.misses + e.misses};
  VisitEvidence groups[2] = {{}, all};
  double least = 1.0;
  for (std::size_t m = 1; m < visits.size(); ++m) {
    const VisitEvidence& e = visits[m - 1];
    groups[0] = {groups[0].hits + e.hits, groups[0].misses + e.misses};
    groups[1] = {std::max(0.0, groups[1].hits - e.hits),
                 std::max(0.0, groups[1].misses - e.misses)};
    if (share_of(groups[0]) < config.few_occupied_share) break;
    if (share_of(groups[1]) > config.few_free_share) continue;
    const double log_ways =
        log_choices(visits.size(), m) + std::log(static_cast<double>(visits.size() - 1));
    least = std::min(least, std::exp(log_ways) * chi_squared_tail(g_statistic(groups), 1));
  }
  return least;
}

namespace {

bool is_contradictory(const VisitTable& table, const Cell& cell, const ContradictionConfig& config,
                      std::span<const Cell> around, std::vector<VisitEvidence>& evidence) {
  const auto visits = table.at(cell);
  if (visits.size() < 2) return false;
  evidence.clear();
  double hits = 0.0;
  double total = 0.0;
  for (const Visit& visit : visits) {
    VisitEvidence e = capped(visit, config.max_evidence);
    if (e.misses > 0.0 && was_hit_nearby(table, cell, visit, around, config.few_free_share)) {
      // Ends beside the cell, on the same surface: no sign that it was free. Mostly free, it was
      // not occupied either: somebody stood there for a while.
      if (share_of(e) < config.few_occupied_share) continue;
      e.misses = 0.0;
    }
    if (e.hits + e.misses < config.min_evidence) continue;
    evidence.push_back(e);
    hits += e.hits;
    total += e.hits + e.misses;
  }
  if (evidence.size() < 2) return false;
  // Among fewer visits the test for few sees what a single one saw.
  if (visits.size() > static_cast<std::size_t>(config.few_max_visits) &&
      two_states_tail(evidence, config) < config.significance) {
    return true;
  }
  const double share = hits / total;
  if (share <= config.min_share || share >= 1.0 - config.min_share) return false;
  const int dof = static_cast<int>(evidence.size()) - 1;
  return chi_squared_tail(g_statistic(evidence), dof) < config.significance;
}

/// Keeps cells that have company: at least `least` set cells in their 3 x 3 block.
Grid<std::uint8_t> drop_lonely(const Grid<std::uint8_t>& mask, int least) {
  Grid<std::uint8_t> result(mask.resolution_m(), mask.rect(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] == 0) continue;
    const Cell cell = mask.cell(i);
    int count = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) count += mask.get({cell.x + dx, cell.y + dy});
    }
    result.values()[i] = count >= least ? 1 : 0;
  }
  return result;
}

/// Whether some visit found the cell free and looked across the surface.
bool was_seen_gone(const VisitTable& table, const Cell& cell, const ContradictionConfig& config,
                   std::span<const Cell> around, const SurfaceSpread& surface) {
  const auto visits = table.at(cell);
  return std::any_of(visits.begin(), visits.end(), [&](const Visit& visit) {
    return static_cast<double>(visit.hits) <= config.few_free_share * visit.total() &&
           surface.is_crossed_by(visit, config.min_across) &&
           !was_hit_nearby(table, cell, visit, around, config.few_free_share);
  });
}

/// Clears the cells of each component that no visit saw free across it. Cells without company make
/// no component, but stay: they are company to others.
void drop_grazed(const VisitTable& table, const ContradictionConfig& config,
                 std::span<const Cell> around, Grid<std::uint8_t>& mask) {
  for_each_component(drop_lonely(mask, config.min_block_cells), CellLink::kOverAGap,
                     [&](const std::vector<Cell>& component) {
                       const SurfaceSpread surface(component);
                       for (const Cell& cell : component) {
                         if (!was_seen_gone(table, cell, config, around, surface))
                           mask.at(cell) = 0;
                       }
                     });
}

/// Clears the components of too few cells. few: of test_few_visits, which asks for fewer where the
/// evidence is strong.
void drop_small(const Grid<std::uint8_t>& few, const ContradictionConfig& config,
                Grid<std::uint8_t>& mask) {
  for_each_component(mask, CellLink::kOverAGap, [&](const std::vector<Cell>& component) {
    if (component.size() >= static_cast<std::size_t>(config.min_component_cells)) return;
    const auto strong = std::count_if(component.begin(), component.end(), [&](const Cell& cell) {
      return few.at(cell) == kStronglyContradictory;
    });
    if (strong >= config.few_strong_cells) return;
    for (const Cell& cell : component) mask.at(cell) = 0;
  });
}

}  // namespace

double chi_squared_tail(double x, int dof) {
  const double half = 0.5 * x;
  const bool odd = dof % 2 != 0;
  // Q(a, half) grows by half^a e^-half / Gamma(a + 1) with each step of a by one.
  double tail = odd ? std::erfc(std::sqrt(half)) : 0.0;
  double a = odd ? 0.5 : 0.0;
  double term = std::exp(-half);
  if (odd) term *= 2.0 * std::sqrt(half / std::numbers::pi);
  for (; a < 0.5 * dof - 0.25; a += 1.0) {
    tail += term;
    term *= half / (a + 1.0);
  }
  return tail;
}

double g_statistic(std::span<const VisitEvidence> visits) {
  double hits = 0.0;
  double misses = 0.0;
  for (const VisitEvidence& e : visits) {
    hits += e.hits;
    misses += e.misses;
  }
  const double total = hits + misses;
  double g = 0.0;
  for (const VisitEvidence& e : visits) {
    const double n = e.hits + e.misses;
    if (e.hits > 0.0) g += e.hits * std::log(e.hits * total / (n * hits));
    if (e.misses > 0.0) g += e.misses * std::log(e.misses * total / (n * misses));
  }
  return 2.0 * g;
}

Grid<std::uint8_t> test_many_visits(const VisitTable& table, const ContradictionConfig& config) {
  Grid<std::uint8_t> mask(table.resolution_m(), table.rect(), 0);
  const std::vector<Cell> around = disc_offsets(config.tolerance_m, table.resolution_m());
  std::vector<VisitEvidence> evidence;
  for (const Cell& cell : table.cells()) {
    if (is_contradictory(table, cell, config, around, evidence)) mask.at(cell) = 1;
  }
  drop_grazed(table, config, around, mask);
  return drop_lonely(mask, config.min_block_cells);
}

Grid<std::uint8_t> find_contradictions(const VisitTable& table, const ContradictionConfig& config) {
  Grid<std::uint8_t> mask = test_many_visits(table, config);
  const Grid<std::uint8_t> few = test_few_visits(table, config);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (few.values()[i] != 0) mask.values()[i] = 1;
  }
  drop_displaced_surfaces(table, config, mask);
  drop_small(few, config, mask);
  return mask;
}

}  // namespace strata::patch
