// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visits.hpp"

#include <algorithm>

#include "core/beam_filter/beam_model.hpp"
#include "core/grid/count_scans.hpp"
#include "core/patch/visit_chains.hpp"
#include "core/patch/visit_clock.hpp"

namespace strata::patch {
namespace {

constexpr std::size_t kProgressStride = 256;

/// A slot for each cell that a beam ended in; -1 elsewhere.
Grid<std::int32_t> make_slots(std::span<const PosedScan> scans, double resolution_m,
                              const CountingOptions& options, std::size_t& count) {
  CellRect rect;
  for (const PosedScan& scan : scans) rect = rect.united(extent_of(scan, resolution_m, options));
  Grid<std::int32_t> slots(resolution_m, rect, -1);
  for (const PosedScan& scan : scans) {
    for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t, const Ray& ray) {
      if (ray.is_hit) slots.at(cell_at(ray.to_m, resolution_m)) = 0;
    });
  }
  count = 0;
  for (std::int32_t& slot : slots.values()) {
    if (slot == 0) slot = static_cast<std::int32_t>(count++);
  }
  return slots;
}

VisitTable table_of(const VisitChains& chains, const std::vector<std::int32_t>& newest,
                    Grid<std::int32_t> slots) {
  std::vector<std::uint32_t> offsets(newest.size() + 1, 0);
  std::vector<Visit> visits;
  for (std::size_t slot = 0; slot < newest.size(); ++slot) {
    offsets[slot] = static_cast<std::uint32_t>(visits.size());
    chains.collect(newest[slot], visits);
  }
  offsets.back() = static_cast<std::uint32_t>(visits.size());
  return {std::move(slots), std::move(offsets), std::move(visits)};
}

}  // namespace

CountingOptions visit_options(const VisitConfig& config, const CountingOptions& counting) {
  CountingOptions options = counting;
  if (config.max_range_m > 0.0 &&
      (options.max_range_m <= 0.0 || options.max_range_m > config.max_range_m)) {
    options.max_range_m = config.max_range_m;
  }
  return options;
}

Eigen::Vector2d clear_end(const Ray& ray, double end_reach_m) {
  if (!ray.is_hit || end_reach_m <= 0.0) return ray.to_m;
  const Eigen::Vector2d along = ray.to_m - ray.from_m;
  const double length_m = along.norm();
  if (length_m <= end_reach_m) return ray.from_m;
  return ray.from_m + (1.0 - end_reach_m / length_m) * along;
}

BeamAxis axis_of(const Ray& ray) {
  const Eigen::Vector2d along = ray.to_m - ray.from_m;
  const double squared = along.squaredNorm();
  if (squared <= 0.0) return {};
  return {static_cast<float>((along.x() * along.x() - along.y() * along.y()) / squared),
          static_cast<float>(2.0 * along.x() * along.y() / squared)};
}

VisitTable::VisitTable(Grid<std::int32_t> slots, std::vector<std::uint32_t> offsets,
                       std::vector<Visit> visits)
    : slots_(std::move(slots)), offsets_(std::move(offsets)), visits_(std::move(visits)) {}

std::vector<Cell> VisitTable::cells() const {
  std::vector<Cell> result;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_.values()[i] >= 0) result.push_back(slots_.cell(i));
  }
  return result;
}

void VisitTable::filter(double prior) {
  for (Visit& visit : visits_) {
    const double total = visit.total();
    if (total <= 0.0) continue;
    const double m = beam_filter::closed_form(
        {static_cast<double>(visit.hits), static_cast<double>(visit.misses)}, prior, 0.0);
    visit.hits = static_cast<float>(m * total);
    const auto misses = static_cast<float>((1.0 - m) * total);
    if (visit.misses > 0.0F) {
      const float scale = misses / visit.misses;
      visit.passing = {scale * visit.passing.cos2, scale * visit.passing.sin2};
    }
    visit.misses = misses;
  }
}

VisitTable find_visits(std::span<const PosedScan> scans, double resolution_m,
                       const VisitConfig& config, const CountingOptions& counting,
                       Progress* progress) {
  const CountingOptions options = visit_options(config, counting);
  std::size_t count = 0;
  Grid<std::int32_t> slots = make_slots(scans, resolution_m, options, count);
  std::vector<std::int32_t> newest(count, -1);
  VisitChains chains;
  VisitClock clock(config);
  for (std::size_t t = 0; t < scans.size(); ++t) {
    if (t % kProgressStride == 0) report_progress(progress, "find visits", t, scans.size());
    const auto scan = static_cast<std::uint32_t>(t);
    clock.advance(scans[t].run, scans[t].scan.stamp, scan);
    for_each_evidence(scans[t], resolution_m, options, config.end_reach_m,
                      [&](const Cell& cell, bool is_hit, float amount, const BeamAxis& axis) {
                        const std::int32_t slot = slots.get(cell);
                        if (slot < 0) return;
                        (void)chains.add(newest[static_cast<std::size_t>(slot)], clock, scan,
                                         is_hit, amount, axis);
                      });
  }
  return table_of(chains, newest, std::move(slots));
}

}  // namespace strata::patch
