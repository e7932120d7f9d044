// SPDX-License-Identifier: Apache-2.0
/// What each visit saw of each cell: the evidence that the contradiction test compares.
///
/// A visit of a cell is a run of scans that see it, ended by a gap of more than `gap_s`, by a
/// change in view, or with the recorded run (docs/theory/patch_maps.md, "Visits"). Kept only for
/// cells that some beam ended in: one never hit cannot contradict itself. Memory is (such cells) x
/// (visits of each).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/ray_traversal.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

/// A beam's direction without its sense: the cosine and sine of twice its angle.
struct BeamAxis {
  float cos2 = 0.0F;
  float sin2 = 0.0F;
};

/// One visit of one cell. Scans are named by their place in the sequence of all scans: 32 bits of
/// them last a robot of 40 scans a second for three years.
struct Visit {
  /// A float that counts takes no more of 1 from 2^24 on. A robot may stand for days: where one
  /// count has come so far, both are halved, which keeps their shares, and says no less.
  static constexpr float kMost = 4'194'304.0F;  // 2^22

  std::uint32_t first_scan = 0;
  std::uint32_t last_scan = 0;
  float hits = 0.0F;    ///< beam ends
  float misses = 0.0F;  ///< length of passing beams in units of the resolution
  BeamAxis passing;     ///< sum of (length of a passing beam in units of the resolution) x its axis

  [[nodiscard]] double total() const {
    return static_cast<double>(hits) + static_cast<double>(misses);
  }
  /// One more beam: of ends, amount 1; of passing beams, their length in units of the resolution.
  void add(bool is_hit, float amount, const BeamAxis& axis) {
    if (is_hit) {
      hits += amount;
    } else {
      misses += amount;
      passing.cos2 += amount * axis.cos2;
      passing.sin2 += amount * axis.sin2;
    }
    bound();
  }
  /// Halves the counts until none is beyond kMost.
  void bound() {
    while (hits > kMost || misses > kMost) {
      hits *= 0.5F;
      misses *= 0.5F;
      passing.cos2 *= 0.5F;
      passing.sin2 *= 0.5F;
    }
  }
  /// Whether the two visits, of neighbouring cells, share time.
  [[nodiscard]] bool overlaps(const Visit& other) const {
    return first_scan <= other.last_scan && other.first_scan <= last_scan;
  }
};

/// The visits of every kept cell, in order of time.
class VisitTable {
 public:
  VisitTable() = default;
  /// offsets[i], offsets[i + 1] bound the visits of the cell whose slot is i; -1: cell not kept.
  VisitTable(Grid<std::int32_t> slots, std::vector<std::uint32_t> offsets,
             std::vector<Visit> visits);

  /// The visits of a cell; empty when it is not kept. O(1).
  [[nodiscard]] std::span<const Visit> at(const Cell& cell) const {
    const std::int32_t slot = slots_.get(cell);
    if (slot < 0) return {};
    const auto s = static_cast<std::size_t>(slot);
    return std::span(visits_).subspan(offsets_[s], offsets_[s + 1] - offsets_[s]);
  }
  [[nodiscard]] const CellRect& rect() const { return slots_.rect(); }
  [[nodiscard]] double resolution_m() const { return slots_.resolution_m(); }
  /// The kept cells, in the order of the grid. O(area).
  [[nodiscard]] std::vector<Cell> cells() const;

  /// The beam filter within each visit (docs/theory/beam_filter.md, "Closed form"): ends in a cell
  /// that the visit's beams mostly cross (people walking by) become misses, totals stay; the
  /// directions of the misses stay those of the beams that passed.
  /// Requires prior in (0.5, 1]. O(visits).
  void filter(double prior);

 private:
  Grid<std::int32_t> slots_{0.05, CellRect{}, -1};
  std::vector<std::uint32_t> offsets_;
  std::vector<Visit> visits_;
};

struct VisitConfig {
  double gap_s = 10.0;
  double min_state_s = 30.0;
  double max_range_m = 8.0;
  double end_reach_m = 0.2;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "gap_s", c.gap_s,
        {.doc = "a cell unseen for longer than this begins a new visit", .unit = "s", .min = 0.0});
    v.field(
        "min_state_s", c.min_state_s,
        {.doc = "a cell in view begins a new visit when it has shown one state for so long, and "
                "then another for so long; 0: never",
         .unit = "s",
         .min = 0.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "contradictions are looked for this far from the laser; errors of heading "
                    "displace what lies farther; 0: no limit",
             .unit = "m",
             .min = 0.0});
    v.field("end_reach_m", c.end_reach_m,
            {.doc = "the last piece of a beam before it ends says nothing about free space: with "
                    "errors of pose it lies inside the surface that the beam met",
             .unit = "m",
             .min = 0.0});
  }
};

/// How scans are counted for visits: `counting`, cut at max_range_m.
[[nodiscard]] CountingOptions visit_options(const VisitConfig& config,
                                            const CountingOptions& counting);

/// Where the part of a beam that says "free" ends.
[[nodiscard]] Eigen::Vector2d clear_end(const Ray& ray, double end_reach_m);

/// The axis of a ray; zero for a ray without length.
[[nodiscard]] BeamAxis axis_of(const Ray& ray);

/// What one scan says of cells: calls visit(cell, is_hit, amount, axis of the beam) for each cell
/// that a beam crosses (amount: length in units of the resolution) and each that one ends in (1).
/// options: of visit_options. O(beams x cells a beam crosses).
template <typename Visit>
void for_each_evidence(const PosedScan& scan, double resolution_m, const CountingOptions& options,
                       double end_reach_m, Visit&& visit) {
  for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t, const Ray& ray) {
    const Cell end = cell_at(ray.to_m, resolution_m);
    const Eigen::Vector2d clear = clear_end(ray, end_reach_m);
    const BeamAxis axis = axis_of(ray);
    traverse_ray(ray.from_m, clear, resolution_m, [&](const Cell& cell, double length_m) {
      if (ray.is_hit && cell == end) return;
      visit(cell, false, static_cast<float>(length_m / resolution_m), axis);
    });
    if (ray.is_hit) visit(end, true, 1.0F, axis);
  });
}

/// Collects the visits of all scans (ordered by run, then time; static probabilities are not used:
/// they judge by the map of all visits, which takes the rarer state of a door for a person).
/// O(beams x cells a beam crosses).
[[nodiscard]] VisitTable find_visits(std::span<const PosedScan> scans, double resolution_m,
                                     const VisitConfig& config, const CountingOptions& counting,
                                     Progress* progress = nullptr);

}  // namespace strata::patch
