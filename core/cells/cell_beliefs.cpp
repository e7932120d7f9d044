// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_beliefs.hpp"

#include <algorithm>
#include <span>

#include "core/grid/counting_map.hpp"
#include "core/grid/tiled_traversal.hpp"

namespace strata::cells {
namespace {

/// A cell that has faded by less than this part waits for more: exp and log cost more than the ray.
constexpr double kMinFade = 0.01;

}  // namespace

ReflectionGrid usual_grid(const CellMap& map) {
  ReflectionGrid grid = make_reflection_grid(map.cells.resolution_m(), map.cells.rect());
  map.cells.visit_rows([&](const Cell& first, std::span<const CellState> row) {
    float* values = &grid.at(first);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i].is_known) values[i] = row[i].is_usually_occupied() ? 1.0F : 0.0F;
    }
  });
  return grid;
}

CellBeliefs::CellBeliefs(const CellMap& map, const CellConfig& config)
    : config_(config),
      evidence_(config),
      cells_(map.cells.resolution_m(), map.cells.rect()),
      grid_(usual_grid(map)) {
  map.cells.visit_rows([&](const Cell& first, std::span<const CellState> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!row[i].is_known) continue;
      const Cell at{first.x + static_cast<int>(i), first.y};
      Followed& cell = cells_.at(at);
      cell.state = row[i];
      cell.index = static_cast<std::uint32_t>(grid_.index(at));
      cell.is_shown = row[i].is_usually_occupied();
    }
  });
}

void CellBeliefs::touch(double nats, Followed& cell) {
  if (!cell.state.is_known) return;
  if (cell.scan != scan_) {
    cell.scan = scan_;
    cell.nats = 0.0F;
    touched_.push_back(&cell);
  }
  cell.nats += static_cast<float>(nats);
}

/// What the scan said of the cell.
void CellBeliefs::take_in(Stamp now, Followed& cell) {
  CellState& state = cell.state;
  const double dt_s = (now - state.stamp).seconds();
  if (dt_s * static_cast<double>(state.rate_per_s) >= kMinFade || dt_s < 0.0) fade_to(now, state);
  const auto most = static_cast<float>(config_.max_nats);
  const auto said = static_cast<float>(
      std::clamp(static_cast<double>(cell.nats), -config_.max_scan_nats, config_.max_scan_nats));
  // What is usual may be surer than scans can make it.
  const float before = state.log_odds;
  state.log_odds = std::clamp(before + said, std::min(before, -most), std::max(before, most));
  if (cell.is_listed || state.is_occupied() == cell.is_shown) return;
  cell.is_listed = true;
  listed_.push_back(&cell);
}

void CellBeliefs::observe(const Scan& scan, const Pose2& map_from_laser) {
  ++scan_;
  touched_.clear();
  const double resolution_m = cells_.resolution_m();
  for_each_ray(scan, map_from_laser, {}, [&](std::size_t /*beam*/, const Ray& ray) {
    const Cell last = cell_at(ray.to_m, resolution_m);
    if (!cells_.contains(last) || !cells_.contains(cell_at(ray.from_m, resolution_m))) return;
    Followed& end = cells_.at(last);
    traverse_ray(cells_, ray.from_m, ray.to_m, [&](Followed& cell, double length_m) {
      if (&cell != &end) touch(evidence_.miss * length_m / resolution_m, cell);
    });
    touch(evidence_.hit, end);
  });
  for (Followed* cell : touched_) take_in(scan.stamp, *cell);
}

bool CellBeliefs::refresh(Stamp now) {
  const double age_s = refreshed_ ? (now - *refreshed_).seconds() : config_.refresh_s;
  if (age_s >= 0.0 && age_s < config_.refresh_s) return false;
  refreshed_ = now;
  bool has_changed = false;
  std::size_t kept = 0;
  for (Followed* cell : listed_) {
    fade_to(now, cell->state);
    const bool is_occupied = cell->state.is_occupied();
    if (is_occupied != cell->is_shown) {
      cell->is_shown = is_occupied;
      grid_.values()[cell->index] = is_occupied ? 1.0F : 0.0F;
      has_changed = true;
    }
    cell->is_listed = is_occupied != cell->state.is_usually_occupied();
    if (cell->is_listed) listed_[kept++] = cell;
  }
  listed_.resize(kept);
  return has_changed;
}

std::optional<double> CellBeliefs::occupied(const Eigen::Vector2d& point_m, Stamp at) const {
  const CellState& state = cells_.get(cell_at(point_m, cells_.resolution_m())).state;
  if (!state.is_known) return std::nullopt;
  const double dt_s = std::max(0.0, (at - state.stamp).seconds());
  return faded(probability_of(static_cast<double>(state.log_odds)), state, dt_s);
}

}  // namespace strata::cells
