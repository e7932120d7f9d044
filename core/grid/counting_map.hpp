// SPDX-License-Identifier: Apache-2.0
/// The counting model: per cell, how often beams ended in it and how much of them passed through.
#pragma once

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/grid/tiled_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// Evidence of one cell. hits: alpha_j, weighted beam ends. misses: beta_j, weighted beam ends
/// judged dynamic plus length of the beams that pass, in units of the resolution.
struct CellCounts {
  double hits = 0.0;
  double misses = 0.0;

  [[nodiscard]] double total() const { return hits + misses; }
};

/// How scans are counted.
struct CountingOptions {
  /// No-return beams free so much, whatever the scan says of them; 0: what the scan says
  /// (docs/theory/beam_filter.md, "No-return beams").
  double no_return_free_range_m = 0.0;
  /// Beams longer than this are cut there and carve only free space; 0: no limit.
  double max_range_m = 0.0;
  /// False: beams without return say nothing, whatever the scan says of them; no setting.
  bool believes_no_returns = true;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "no_return_free_range_m", c.no_return_free_range_m,
        {.doc = "free space carved by every beam without return; 0: by those that are told from "
                "returns that dropped out, as far as the scanner is found to see",
         .unit = "m",
         .min = 0.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "longer beams are cut here and only carve free space; 0: no limit",
             .unit = "m",
             .min = 0.0,
             .when = "far readings of your scanner are not to be trusted"});
  }
};

/// What a beam end counts.
enum class BeamWeights {
  kStaticProbability,  ///< e to the hits, 1 - e to the misses; e = 1 when the scan has none
  kAllStatic,          ///< one hit each, whatever static_probability says
};

/// alpha_j, beta_j of [stachniss2003chapter] eqs. (1.12)-(1.15), with beams weighted by length: a
/// beam adds l_k = (length inside the cell) / resolution to the misses of each cell it crosses; the
/// cell where it ends gets no miss from it. Memory follows the cells that beams crossed.
class CountingMap {
 public:
  explicit CountingMap(double resolution_m = 0.05) : cells_(resolution_m) {}
  explicit CountingMap(TiledGrid<CellCounts> cells) : cells_(std::move(cells)) {}

  [[nodiscard]] const TiledGrid<CellCounts>& cells() const { return cells_; }
  [[nodiscard]] TiledGrid<CellCounts>& cells() { return cells_; }
  [[nodiscard]] double resolution_m() const { return cells_.resolution_m(); }

  /// Adds every beam of a scan; grows as needed. A hit in the end cell counts e (its static
  /// probability, 1 when the scan has none) and 1 - e goes to that cell's misses. weight scales
  /// all: -1 takes a scan out again. O(beams x cells a beam crosses).
  void add(const PosedScan& scan, const CountingOptions& options = {}, double weight = 1.0,
           BeamWeights beams = BeamWeights::kStaticProbability);

  /// The same, while what was counted before fades in each cell that the scan looks at: of it
  /// 1 - 1 / `scans` is left, however many of its beams cross the cell. Requires scans > 1.
  void add_fading(const PosedScan& scan, const CountingOptions& options, BeamWeights beams,
                  double scans);
  /// The same as add() without cells to spare around the beams.
  void add_tightly(const PosedScan& scan, const CountingOptions& options, BeamWeights beams);
  /// Adds the counts of another map of the same resolution. O(cells that its beams crossed).
  void add(const CountingMap& other);

  /// m_j = hits / (hits + misses); unknown where the total is below min_evidence. O(cells).
  [[nodiscard]] ReflectionGrid reflection(double min_evidence = 0.5) const;

 private:
  template <typename Cover, typename Fade>
  void count(const PosedScan& scan, const CountingOptions& options, double weight,
             BeamWeights beams, const Cover& cover, const Fade& fade);
  TiledGrid<CellCounts> cells_;
};

/// Where a beam's ray starts and ends in the map, and whether it ends in a hit.
struct Ray {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  bool is_hit = false;
};
/// Calls visit(beam index, Ray) for every beam of the scan that says something: not for one that is
/// invalid or too close, nor without return where it is not known how far it saw. O(beams).
template <typename Visit>
void for_each_ray(const Scan& scan, const Pose2& map_from_laser, const CountingOptions& options,
                  Visit&& visit) {
  const Eigen::Vector2d from = map_from_laser.translation();
  auto dropped = scan.drop_outs.begin();
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    const BeamKind kind = scan.kind(beam);
    if (kind == BeamKind::kInvalid || kind == BeamKind::kTooClose) continue;
    bool is_hit = kind == BeamKind::kHit;
    if (!is_hit && !options.believes_no_returns) continue;
    double length_m = static_cast<double>(is_hit ? scan.ranges_m[beam] : scan.free_range_m);
    if (!is_hit && options.no_return_free_range_m > 0.0) {
      length_m = options.no_return_free_range_m;
    } else if (!is_hit) {
      while (dropped != scan.drop_outs.end() && *dropped < beam) ++dropped;
      if (dropped != scan.drop_outs.end() && *dropped == beam) continue;
    }
    if (options.max_range_m > 0.0 && length_m > options.max_range_m) {
      length_m = options.max_range_m;
      is_hit = false;
    }
    if (length_m <= 0.0) continue;
    const double angle = map_from_laser.theta + scan.bearing_rad(beam);
    visit(beam,
          Ray{from, from + length_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)), is_hit});
  }
}

}  // namespace strata
