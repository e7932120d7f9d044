// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visits.hpp"

#include <algorithm>

#include "core/beam_filter/beam_model.hpp"
#include "core/grid/count_scans.hpp"

namespace strata::patch {
namespace {

constexpr std::size_t kProgressStride = 256;

/// A visit under construction, linked to the previous visit of the same cell.
struct LinkedVisit {
  Visit visit;
  std::int32_t previous = -1;
};

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

/// Appends visits per slot while the scans go by.
class VisitCollector {
 public:
  VisitCollector(std::span<const PosedScan> scans, std::size_t slots, Duration gap)
      : scans_(scans), gap_(gap), last_(slots, -1) {}

  Visit& current(std::int32_t slot, std::uint32_t scan) {
    std::int32_t& last = last_[static_cast<std::size_t>(slot)];
    if (last < 0 || is_new_visit(links_[static_cast<std::size_t>(last)].visit.last_scan, scan)) {
      links_.push_back({Visit{scan, scan, 0.0F, 0.0F, {}}, last});
      last = static_cast<std::int32_t>(links_.size()) - 1;
    }
    Visit& visit = links_[static_cast<std::size_t>(last)].visit;
    visit.last_scan = scan;
    return visit;
  }

  VisitTable finish(Grid<std::int32_t> slots) && {
    std::vector<std::uint32_t> offsets(last_.size() + 1, 0);
    std::vector<Visit> visits;
    visits.reserve(links_.size());
    for (std::size_t slot = 0; slot < last_.size(); ++slot) {
      offsets[slot] = static_cast<std::uint32_t>(visits.size());
      for (std::int32_t i = last_[slot]; i >= 0; i = links_[static_cast<std::size_t>(i)].previous) {
        visits.push_back(links_[static_cast<std::size_t>(i)].visit);
      }
      std::reverse(visits.begin() + offsets[slot], visits.end());
    }
    offsets.back() = static_cast<std::uint32_t>(visits.size());
    return {std::move(slots), std::move(offsets), std::move(visits)};
  }

 private:
  [[nodiscard]] bool is_new_visit(std::uint32_t before, std::uint32_t now) const {
    return scans_[before].run != scans_[now].run ||
           scans_[now].scan.stamp - scans_[before].scan.stamp > gap_;
  }
  std::span<const PosedScan> scans_;
  Duration gap_;
  std::vector<std::int32_t> last_;
  std::vector<LinkedVisit> links_;
};

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
  VisitCollector collector(scans, count, Duration::from_seconds(config.gap_s));
  for (std::size_t t = 0; t < scans.size(); ++t) {
    if (t % kProgressStride == 0) report_progress(progress, "find visits", t, scans.size());
    const auto scan = static_cast<std::uint32_t>(t);
    for_each_evidence(scans[t], resolution_m, options, config.end_reach_m,
                      [&](const Cell& cell, bool is_hit, float amount, const BeamAxis& axis) {
                        const std::int32_t slot = slots.get(cell);
                        if (slot >= 0) collector.current(slot, scan).add(is_hit, amount, axis);
                      });
  }
  return std::move(collector).finish(std::move(slots));
}

}  // namespace strata::patch
