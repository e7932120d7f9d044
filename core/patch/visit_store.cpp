// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visit_store.hpp"

#include <algorithm>
#include <utility>

#include "core/beam_filter/beam_model.hpp"

namespace strata::patch {
namespace {

/// Side of a tile. News are kept per tile, not per cell.
constexpr int kTileCells = 32;

int tile_of(int cell) {
  return cell >= 0 ? cell / kTileCells : -((-cell + kTileCells - 1) / kTileCells);
}
CellRect cells_of_tile(const Cell& tile) {
  return {{tile.x * kTileCells, tile.y * kTileCells},
          {(tile.x + 1) * kTileCells, (tile.y + 1) * kTileCells}};
}

}  // namespace

VisitStore::VisitStore(double resolution_m, const VisitConfig& config,
                       const CountingOptions& counting, int most)
    : config_(config),
      options_(visit_options(config, counting)),
      max_(std::max(2, most)),
      last_(resolution_m, CellRect{}, -1),
      touched_(resolution_m, CellRect{}, 0),
      clock_(config),
      changed_(resolution_m, CellRect{}, 0) {}

void VisitStore::advance(const PosedScan& scan, std::uint32_t index) {
  clock_.advance(scan.run, scan.scan.stamp, index);
}

void VisitStore::add(const PosedScan& scan, std::uint32_t index) {
  const double resolution = last_.resolution_m();
  CellRect needed;
  for_each_ray(scan.scan, scan.map_from_laser(), options_, [&](std::size_t, const Ray& ray) {
    for (const Eigen::Vector2d& end : {ray.from_m, ray.to_m}) {
      const Cell cell = cell_at(end, resolution);
      needed = needed.united({cell, {cell.x + 1, cell.y + 1}});
    }
  });
  if (needed.empty()) return;
  last_.grow(needed);
  const CellRect tiles{{tile_of(needed.min.x), tile_of(needed.min.y)},
                       {tile_of(needed.max.x) + 1, tile_of(needed.max.y) + 1}};
  if (touched_.rect().united(tiles) != touched_.rect()) {
    Grid<std::uint8_t> changed = changed_;
    changed.grow(tiles);
    touched_.grow(tiles);
    changed_ = std::move(changed);  // both or none, where memory runs out
  }
  for_each_evidence(scan, resolution, options_, config_.end_reach_m,
                    [&](const Cell& cell, bool is_hit, float amount, const BeamAxis& axis) {
                      const Cell tile{tile_of(cell.x), tile_of(cell.y)};
                      touched_.at(tile) = index + 1;
                      std::int32_t& newest = last_.at(cell);
                      if (!chains_.add(newest, clock_, index, is_hit, amount, axis)) return;
                      if (chains_.follows_change(newest, clock_)) changed_.at(tile) = 1;
                      chains_.forget_surplus(newest, max_);
                    });
}

std::vector<CellRect> VisitStore::take_ended(double window_m) {
  const int max_cells = static_cast<int>(window_m / last_.resolution_m());
  std::vector<CellRect> tiles;
  CellRect window;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    std::uint32_t& touched = touched_.values()[i];
    const Cell place = touched_.cell(i);
    std::uint8_t& changed = changed_.at(place);
    const bool has_ended = touched != 0 && touched - 1 < clock_.joins_from();
    if (!has_ended && changed == 0) continue;
    const CellRect tile = cells_of_tile(place);
    const CellRect united = window.united(tile);
    if (!tiles.empty() && std::max(united.width(), united.height()) > max_cells) continue;
    window = united;
    tiles.push_back(tile);
    changed = 0;
    if (has_ended) touched = 0;
  }
  return tiles;
}

VisitTable VisitStore::table(const CellRect& window) const {
  const CellRect rect = window.intersected(last_.rect());
  Grid<std::int32_t> slots(last_.resolution_m(), rect, -1);
  std::vector<std::uint32_t> offsets{0};
  std::vector<Visit> visits;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::size_t begin = visits.size();
    chains_.collect(last_.at(slots.cell(i)), visits);
    float hits = 0.0F;
    for (std::size_t v = begin; v < visits.size(); ++v) hits += visits[v].hits;
    if (hits <= 0.0F) {
      visits.resize(begin);
      continue;
    }
    slots.values()[i] = static_cast<std::int32_t>(offsets.size()) - 1;
    offsets.push_back(static_cast<std::uint32_t>(visits.size()));
  }
  return {std::move(slots), std::move(offsets), std::move(visits)};
}

ReflectionGrid VisitStore::extended(const ReflectionGrid& known, double prior,
                                    double min_evidence) const {
  CellRect seen;
  std::vector<std::pair<Cell, float>> found;
  std::vector<Visit> visits;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    if (last_.values()[i] < 0) continue;
    const Cell cell = last_.cell(i);
    if (is_known(known.get(cell))) continue;
    CellCounts counts;
    visits.clear();
    chains_.collect(last_.values()[i], visits);
    for (const Visit& visit : visits) {
      counts.hits += static_cast<double>(visit.hits);
      counts.misses += static_cast<double>(visit.misses);
    }
    const auto m = static_cast<float>(beam_filter::closed_form(counts, prior, min_evidence));
    if (!is_known(m)) continue;
    found.emplace_back(cell, m);
    seen = seen.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (found.empty()) return known;
  ReflectionGrid result = known.cropped(known.rect().united(seen));
  for (const auto& [cell, m] : found) result.at(cell) = m;
  return result;
}

void VisitStore::trim(int most) {
  max_ = std::max(2, most);
  for (std::int32_t& last : last_.values()) {
    chains_.end_trial(last);
    chains_.forget_surplus(last, max_);
  }
  chains_.pack(last_.values());
}

std::size_t VisitStore::bytes() const {
  return chains_.bytes() + clock_.bytes() + last_.size() * sizeof(std::int32_t) +
         touched_.size() * (sizeof(std::uint32_t) + sizeof(std::uint8_t));
}

bool VisitStore::is_sound(double resolution_m) const {
  return max_ >= 2 && last_.resolution_m() == resolution_m &&
         touched_.resolution_m() == resolution_m && changed_.resolution_m() == resolution_m &&
         changed_.rect() == touched_.rect() && chains_.is_sound(last_.values());
}

}  // namespace strata::patch
