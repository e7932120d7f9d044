// SPDX-License-Identifier: Apache-2.0
#include "core/patch/contradiction.hpp"

#include <cmath>
#include <numbers>

namespace strata::patch {
namespace {

VisitEvidence capped(const Visit& visit, double max_evidence) {
  const double total = visit.total();
  const double scale = total > max_evidence ? max_evidence / total : 1.0;
  return {scale * static_cast<double>(visit.hits), scale * static_cast<double>(visit.misses)};
}

/// For each visit of `visits`: whether a visit of `others` that shares time with it hit its cell.
/// Both are in order of time, so one sweep does.
void mark_overlapping_hits(std::span<const Visit> visits, std::span<const Visit> others,
                           double max_evidence, std::vector<std::uint8_t>& marks) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    while (begin < others.size() && others[begin].last_scan < visits[i].first_scan) ++begin;
    for (std::size_t k = begin; k < others.size() && others[k].overlaps(visits[i]); ++k) {
      if (capped(others[k], max_evidence).hits > 0.5) marks[i] = 1;
    }
  }
}

/// Scratch memory of the test of one cell.
struct CellTest {
  std::vector<VisitEvidence> evidence;
  std::vector<std::uint8_t> neighbour_hit;
};

bool is_contradictory(const VisitTable& table, const Cell& cell, const ContradictionConfig& config,
                      CellTest& scratch) {
  const auto visits = table.at(cell);
  if (visits.size() < 2) return false;
  scratch.neighbour_hit.assign(visits.size(), 0);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      mark_overlapping_hits(visits, table.at({cell.x + dx, cell.y + dy}), config.max_evidence,
                            scratch.neighbour_hit);
    }
  }
  scratch.evidence.clear();
  double hits = 0.0;
  double total = 0.0;
  for (std::size_t s = 0; s < visits.size(); ++s) {
    VisitEvidence e = capped(visits[s], config.max_evidence);
    if (scratch.neighbour_hit[s] != 0) e.misses = 0.0;
    if (e.hits + e.misses < config.min_evidence) continue;
    scratch.evidence.push_back(e);
    hits += e.hits;
    total += e.hits + e.misses;
  }
  if (scratch.evidence.size() < 2) return false;
  const double share = hits / total;
  if (share <= config.min_share || share >= 1.0 - config.min_share) return false;
  const int dof = static_cast<int>(scratch.evidence.size()) - 1;
  return chi_squared_tail(g_statistic(scratch.evidence), dof) < config.significance;
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
  CellTest scratch;
  for (const Cell& cell : table.cells()) {
    if (is_contradictory(table, cell, config, scratch)) mask.at(cell) = 1;
  }
  return drop_lonely(mask, config.min_block_cells);
}

Grid<std::uint8_t> find_contradictions(const VisitTable& table, const ContradictionConfig& config) {
  Grid<std::uint8_t> mask = test_many_visits(table, config);
  const Grid<std::uint8_t> few = test_few_visits(table, config);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask.values()[i] = static_cast<std::uint8_t>(mask.values()[i] | few.values()[i]);
  }
  return mask;
}

}  // namespace strata::patch
