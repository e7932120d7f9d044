// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_learner.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/grid/count_scans.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/tiled_traversal.hpp"

namespace strata::cells {
namespace {

/// Looks closer together than this are of one visit.
constexpr double kSoon_s = 60.0;
constexpr std::size_t kLastLook = 2;
constexpr double kMinSightings = 0.01;
constexpr double kMaxSightings = 0.5;

std::size_t kind_of(double dt_s) { return dt_s < kSoon_s ? 0 : 1; }

Stamp middle(Stamp begin, Stamp end) { return begin + Duration{(end - begin).ns / 2}; }

/// Another look, which is an entry of its own as long as it is the last one.
void append(int last_state, double dt_s, patch::SequenceHistory& history) {
  history.append(dt_s);
  if (history.size() > kLastLook + 1) {
    history.pool(kLastLook, static_cast<std::size_t>(last_state));
  }
}

}  // namespace

CellLearner::CellLearner(double resolution_m, const CellConfig& config)
    : config_(config), evidence_(config), watches_(resolution_m) {}

void CellLearner::add(const PosedScan& scan) {
  const double resolution_m = watches_.resolution_m();
  CellRect needed;
  const auto for_rays = [&](const auto& visit) {
    // Scans that were kept do not tell what those say.
    for_each_ray(scan.scan, scan.map_from_laser(), {.believes_no_returns = false}, visit);
  };
  for_rays([&](std::size_t /*beam*/, const Ray& ray) {
    needed = needed.united(extent_of(ray, resolution_m));
  });
  if (needed.empty()) return;
  watches_.grow(with_room(watches_.rect(), needed));
  for_rays([&](std::size_t /*beam*/, const Ray& ray) {
    Watch& end = watches_.at(cell_at(ray.to_m, resolution_m));
    look(scan, end);
    const float misses = end.misses;
    traverse_ray(watches_, ray.from_m, ray.to_m, [&](Watch& watch, double length_m) {
      look(scan, watch);
      watch.misses += static_cast<float>(length_m / resolution_m);
    });
    // The cell where the beam ends gets no miss from it.
    end.misses = misses;
    end.hits += 1.0F;
  });
}

/// The scan sees something of the cell.
void CellLearner::look(const PosedScan& scan, Watch& watch) {
  const Stamp now = scan.scan.stamp;
  if (watch.end == now && watch.run == scan.run) return;
  const bool goes_on = watch.run == scan.run && watch.end < now &&
                       (now - watch.end).seconds() <= config_.gap_s &&
                       (now - watch.begin).seconds() <= config_.max_look_s;
  if (!goes_on) {
    end_look(watch);
    watch.begin = now;
    watch.run = scan.run;
  }
  watch.end = now;
}

void CellLearner::end_look(Watch& watch) {
  const double nats = static_cast<double>(watch.hits) * evidence_.hit +
                      static_cast<double>(watch.misses) * evidence_.miss;
  watch.hits = 0.0F;
  watch.misses = 0.0F;
  if (std::abs(nats) < config_.min_look_nats) return;
  const Stamp at = middle(watch.begin, watch.end);
  const double dt_s = watch.last_state < 0 ? 0.0 : (at - watch.last_middle).seconds();
  add_look(nats > 0.0 ? 1 : 0, dt_s, watch);
  watch.last_middle = at;
}

/// dt_s after the last one; 0 or less: nobody knows how long after.
void CellLearner::add_look(int state, double dt_s, Watch& watch) {
  const bool is_known = dt_s > 0.0;
  if (is_known) (state == watch.last_state ? sames_ : changes_) += 1.0;
  if (watch.history < 0 && (watch.last_state < 0 || state == watch.last_state)) {
    watch.last_state = static_cast<std::int8_t>(state);
    if (!is_known) {
      watch.firsts += 1.0F;
      return;
    }
    Same& same = watch.same[kind_of(dt_s)];
    same.count += 1.0F;
    same.time_s += static_cast<float>(dt_s);
    return;
  }
  if (watch.history < 0) {
    watch.history = static_cast<std::int32_t>(histories_.size());
    patch::SequenceHistory& history = histories_.emplace_back(kLastLook);
    for (float i = 0.0F; i < watch.firsts; i += 1.0F) {
      append(watch.last_state, 0.0, history);
    }
    for (const Same& same : watch.same) {
      for (float i = 0.0F; i < same.count; i += 1.0F) {
        append(watch.last_state, static_cast<double>(same.time_s / same.count), history);
      }
    }
  }
  append(watch.last_state, dt_s, histories_[static_cast<std::size_t>(watch.history)]);
  watch.last_state = static_cast<std::int8_t>(state);
}

void CellLearner::pool_prior(CellMap& map) const {
  // Of shares that are Beta(s, s) two looks differ with probability s / (2 s + 1).
  const double differ = changes_ / std::max(1.0, changes_ + sames_);
  map.sightings =
      std::clamp(differ / std::max(1e-6, 1.0 - 2.0 * differ), kMinSightings, kMaxSightings);
  map.rate_per_s = config_.chain.prior_changes / config_.chain.prior_hours / 3600.0;
}

/// One sweep of what learn_chain() does, at the map's rate: a cell that never changed says little
/// of its own.
CellState CellLearner::static_cell(const Watch& watch, const CellMap& map) const {
  double draws = static_cast<double>(watch.firsts);
  for (const Same& same : watch.same) {
    if (!(same.count > 0.0F)) continue;
    const double dt_s = static_cast<double>(same.time_s / same.count);
    draws += static_cast<double>(same.count) * -std::expm1(-map.rate_per_s * dt_s);
  }
  const double other = map.sightings / (draws + 2.0 * map.sightings);
  CellState cell;
  cell.usual = static_cast<float>(watch.last_state == 1 ? 1.0 - other : other);
  cell.rate_per_s = static_cast<float>(map.rate_per_s);
  return cell;
}

CellState CellLearner::changing_cell(const Watch& watch, const patch::ChainConfig& config) const {
  const double right = 1.0 - config_.look_error;
  const double wrong = config_.look_error;
  std::vector<std::vector<double>> looks{{right, wrong}, {wrong, right}};
  looks.push_back(looks[static_cast<std::size_t>(watch.last_state)]);
  const patch::Chain chain =
      patch::learn_chain(looks, histories_[static_cast<std::size_t>(watch.history)], config);
  CellState cell;
  cell.usual = static_cast<float>(chain.usual[1]);
  cell.rate_per_s = static_cast<float>(chain.rate_per_s);
  return cell;
}

CellMap CellLearner::finish(WorkerPool& pool) {
  struct Place {
    const Watch* watch;
    CellState* cell;
  };
  std::vector<Place> places;
  CellMap map;
  map.cells = TiledGrid<CellState>(watches_.resolution_m(), watches_.rect());
  const CellRect rect = watches_.rect();
  watches_.visit_rows([&](const Cell& first, std::span<const Watch> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Cell at{first.x + static_cast<int>(i), first.y};
      if (row[i].run < 0 || !rect.contains(at)) continue;
      Watch& watch = watches_.at(at);
      end_look(watch);
      if (watch.last_state >= 0) places.push_back({&watch, &map.cells.at(at)});
    }
  });
  map.known = places.size();
  map.changed = histories_.size();
  pool_prior(map);
  patch::ChainConfig chain = config_.chain;
  chain.prior_sightings = map.sightings;
  constexpr std::size_t kChunk = 1024;
  pool.for_chunks(
      places.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
        for (std::size_t i = begin; i < end; ++i) {
          const Watch& watch = *places[i].watch;
          CellState& cell = *places[i].cell;
          cell = watch.history < 0 ? static_cell(watch, map) : changing_cell(watch, chain);
          cell.log_odds = static_cast<float>(log_odds_of(static_cast<double>(cell.usual)));
          cell.stamp = watch.last_middle;
          cell.is_known = true;
        }
      });
  return map;
}

}  // namespace strata::cells
