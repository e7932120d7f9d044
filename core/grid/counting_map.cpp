// SPDX-License-Identifier: Apache-2.0
#include "core/grid/counting_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/grid/count_scans.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/tiled_traversal.hpp"

namespace strata {

namespace {

/// What was counted stays.
struct ForEver {};

/// Of what was counted 1 - 1 / scans is left after a scan, so many of whose beams cross a cell:
/// each takes its part.
struct Fading {
  Fading(const Scan& scan, double resolution_m, double scans)
      : a_metre(std::abs(static_cast<double>(scan.angle_increment_rad)) / (resolution_m * scans)),
        min(1.0 / (scans * static_cast<double>(std::max<std::size_t>(scan.size(), 1)))),
        max(1.0 / scans) {}
  void operator()(CellCounts& counts, double distance_m) const {
    const double left = 1.0 - std::min(std::max(a_metre * distance_m, min), max);
    counts.hits *= left;
    counts.misses *= left;
  }
  double a_metre;  // what a beam takes grows with the distance between two of them
  double min;
  double max;
};

}  // namespace

/// fade(counts, distance): before a beam counts in a cell at that distance from the laser; or
/// ForEver.
template <typename Cover, typename Fade>
void CountingMap::count(const PosedScan& scan, const CountingOptions& options, double weight,
                        BeamWeights beams, const Cover& cover, [[maybe_unused]] const Fade& fade) {
  constexpr bool kFades = !std::is_same_v<Fade, ForEver>;
  const double resolution = resolution_m();
  std::vector<std::pair<std::size_t, Ray>> rays;
  rays.reserve(scan.scan.size());
  CellRect needed;
  for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t beam, const Ray& ray) {
    rays.emplace_back(beam, ray);
    needed = needed.united(extent_of(ray, resolution));
  });
  if (needed.empty()) return;
  cover(needed);
  const bool weighted =
      beams == BeamWeights::kStaticProbability && !scan.static_probability.empty();
  const double per_cell = weight / resolution;
  for (const auto& [beam, ray] : rays) {
    CellCounts& end = cells_.at(cell_at(ray.to_m, resolution));
    const CellCounts before = end;
    [[maybe_unused]] double distance_m = 0.0;
    traverse_ray(cells_, ray.from_m, ray.to_m, [&](CellCounts& counts, double length_m) {
      if constexpr (kFades) {
        fade(counts, distance_m);
        distance_m += length_m;
      }
      counts.misses += per_cell * length_m;
    });
    if (!ray.is_hit) continue;
    const double e = weighted ? static_cast<double>(scan.static_probability[beam]) : 1.0;
    // The cell where the beam ends gets no miss from it.
    end = before;
    if constexpr (kFades) fade(end, distance_m);
    end.misses += weight * (1.0 - e);
    end.hits += weight * e;
  }
}

void CountingMap::add(const PosedScan& scan, const CountingOptions& options, double weight,
                      BeamWeights beams) {
  count(
      scan, options, weight, beams,
      [&](const CellRect& needed) { cells_.grow(with_room(cells_.rect(), needed)); }, ForEver{});
}

void CountingMap::add_fading(const PosedScan& scan, const CountingOptions& options,
                             BeamWeights beams, double scans) {
  const Fading fading(scan.scan, resolution_m(), scans);
  count(
      scan, options, 1.0, beams,
      [&](const CellRect& needed) { cells_.grow(with_room(cells_.rect(), needed)); }, fading);
}

void CountingMap::add_tightly(const PosedScan& scan, const CountingOptions& options,
                              BeamWeights beams) {
  count(
      scan, options, 1.0, beams, [&](const CellRect& needed) { cells_.cover(needed); }, ForEver{});
}

void CountingMap::add(const CountingMap& other) {
  cells_.cover(other.cells_.rect());
  other.cells_.visit_rows([&](const Cell& first, std::span<const CellCounts> row) {
    CellCounts* sum = &cells_.at(first);
    for (std::size_t i = 0; i < row.size(); ++i) {
      sum[i].hits += row[i].hits;
      sum[i].misses += row[i].misses;
    }
  });
}

ReflectionGrid CountingMap::reflection(double min_evidence) const {
  ReflectionGrid result = make_reflection_grid(resolution_m(), cells_.rect());
  cells_.visit_rows([&](const Cell& first, std::span<const CellCounts> row) {
    float* values = &result.at(first);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i].total() < min_evidence) continue;
      values[i] = static_cast<float>(row[i].hits / row[i].total());
    }
  });
  return result;
}

}  // namespace strata
