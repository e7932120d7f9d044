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

bool is_occupied_in(const Visit& visit) { return visit.hits >= visit.misses; }

}  // namespace

VisitStore::VisitStore(double resolution_m, const VisitConfig& config,
                       const CountingOptions& counting, int most)
    : config_(config),
      options_(visit_options(config, counting)),
      max_(std::max(2, most)),
      last_(resolution_m, CellRect{}, -1),
      touched_(resolution_m, CellRect{}, 0) {}

void VisitStore::advance(const PosedScan& scan, std::uint32_t index) {
  if (run_ != scan.run) {
    recent_.clear();
    run_ = scan.run;
  }
  while (!recent_.empty() && (scan.scan.stamp - recent_.front().second).seconds() > config_.gap_s) {
    recent_.pop_front();
  }
  recent_.emplace_back(index, scan.scan.stamp);
  joins_from_ = recent_.front().first;
}

Visit& VisitStore::current(const Cell& cell, std::uint32_t index) {
  std::int32_t& last = last_.at(cell);
  if (last < 0 || node(last).visit.last_scan < joins_from_) {
    std::int32_t fresh = free_;
    if (fresh < 0) {
      fresh = static_cast<std::int32_t>(nodes_.size());
      nodes_.emplace_back();
    } else {
      free_ = node(fresh).previous;
    }
    node(fresh) = {Visit{index, index, 0.0F, 0.0F, {}}, last};
    last = fresh;
    forget_surplus(last);
  }
  Visit& visit = node(last).visit;
  visit.last_scan = index;
  return visit;
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
  touched_.grow({{tile_of(needed.min.x), tile_of(needed.min.y)},
                 {tile_of(needed.max.x) + 1, tile_of(needed.max.y) + 1}});
  for_each_evidence(scan, resolution, options_, config_.end_reach_m,
                    [&](const Cell& cell, bool is_hit, float amount, const BeamAxis& axis) {
                      current(cell, index).add(is_hit, amount, axis);
                      touched_.at({tile_of(cell.x), tile_of(cell.y)}) = index + 1;
                    });
}

std::vector<CellRect> VisitStore::take_ended(double window_m) {
  const int max_cells = static_cast<int>(window_m / last_.resolution_m());
  std::vector<CellRect> tiles;
  CellRect window;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    std::uint32_t& touched = touched_.values()[i];
    if (touched == 0 || touched - 1 >= joins_from_) continue;
    const CellRect tile = cells_of_tile(touched_.cell(i));
    const CellRect united = window.united(tile);
    if (!tiles.empty() && std::max(united.width(), united.height()) > max_cells) continue;
    window = united;
    tiles.push_back(tile);
    touched = 0;
  }
  return tiles;
}

VisitTable VisitStore::table(const CellRect& window) const {
  const CellRect rect = window.intersected(last_.rect());
  Grid<std::int32_t> slots(last_.resolution_m(), rect, -1);
  std::vector<std::uint32_t> offsets{0};
  std::vector<Visit> visits;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(visits.size());
    float hits = 0.0F;
    for (std::int32_t n = last_.at(slots.cell(i)); n >= 0; n = node(n).previous) {
      visits.push_back(node(n).visit);
      hits += node(n).visit.hits;
    }
    if (hits <= 0.0F) {
      visits.resize(static_cast<std::size_t>(begin));
      continue;
    }
    std::reverse(visits.begin() + begin, visits.end());
    slots.values()[i] = static_cast<std::int32_t>(offsets.size()) - 1;
    offsets.push_back(static_cast<std::uint32_t>(visits.size()));
  }
  return {std::move(slots), std::move(offsets), std::move(visits)};
}

ReflectionGrid VisitStore::extended(const ReflectionGrid& known, double prior,
                                    double min_evidence) const {
  CellRect seen;
  std::vector<std::pair<Cell, float>> found;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    if (last_.values()[i] < 0) continue;
    const Cell cell = last_.cell(i);
    if (is_known(known.get(cell))) continue;
    CellCounts counts;
    for (std::int32_t n = last_.values()[i]; n >= 0; n = node(n).previous) {
      counts.hits += static_cast<double>(node(n).visit.hits);
      counts.misses += static_cast<double>(node(n).visit.misses);
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

void VisitStore::forget_surplus(std::int32_t last) {
  int count = 0;
  int occupied = 0;
  for (std::int32_t n = last; n >= 0; n = node(n).previous) {
    ++count;
    if (n != last && is_occupied_in(node(n).visit)) ++occupied;
  }
  for (; count > max_; --count) {
    const bool drops_occupied = 2 * occupied >= count - 1;
    std::int32_t after = -1;  // the node whose previous one goes
    for (std::int32_t n = last; node(n).previous >= 0; n = node(n).previous) {
      if (is_occupied_in(node(node(n).previous).visit) == drops_occupied) after = n;
    }
    const std::int32_t gone = node(after).previous;
    node(after).previous = node(gone).previous;
    node(gone) = {Visit{}, free_};
    free_ = gone;
    if (drops_occupied) --occupied;
  }
}

void VisitStore::trim(int most) {
  max_ = std::max(2, most);
  for (const std::int32_t last : last_.values()) {
    if (last >= 0) forget_surplus(last);
  }
  // Packed anew, so that what was forgotten is given back.
  std::deque<Node> packed;
  for (std::int32_t& last : last_.values()) {
    std::int32_t* link = &last;
    for (std::int32_t n = last; n >= 0;) {
      packed.push_back(node(n));
      *link = static_cast<std::int32_t>(packed.size()) - 1;
      n = packed.back().previous;
      link = &packed.back().previous;
    }
  }
  nodes_ = std::move(packed);
  free_ = -1;
}

std::size_t VisitStore::bytes() const {
  return nodes_.size() * sizeof(Node) + last_.size() * sizeof(std::int32_t) +
         touched_.size() * sizeof(std::uint32_t) +
         recent_.size() * sizeof(std::pair<std::uint32_t, Stamp>);
}

bool VisitStore::is_sound(double resolution_m) const {
  const bool is_aligned =
      last_.resolution_m() == resolution_m && touched_.resolution_m() == resolution_m;
  std::vector<bool> is_reached(nodes_.size(), false);
  const auto leads_to_new_nodes = [&](std::int32_t i) {
    for (; i >= 0; i = node(i).previous) {
      const auto n = static_cast<std::size_t>(i);
      if (n >= nodes_.size() || is_reached[n]) return false;
      is_reached[n] = true;
    }
    return i == -1;
  };
  return max_ >= 2 && is_aligned && leads_to_new_nodes(free_) &&
         std::all_of(last_.values().begin(), last_.values().end(), leads_to_new_nodes);
}

}  // namespace strata::patch
