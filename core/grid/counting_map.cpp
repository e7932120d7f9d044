// SPDX-License-Identifier: Apache-2.0
#include "core/grid/counting_map.hpp"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/count_scans.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/tiled_traversal.hpp"

namespace strata {

template <typename Cover>
void CountingMap::count(const PosedScan& scan, const CountingOptions& options, double weight,
                        BeamWeights beams, const Cover& cover) {
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
    const double before = end.misses;
    traverse_ray(cells_, ray.from_m, ray.to_m, [&](CellCounts& counts, double length_m) {
      counts.misses += per_cell * length_m;
    });
    if (!ray.is_hit) continue;
    const double e = weighted ? static_cast<double>(scan.static_probability[beam]) : 1.0;
    // The cell where the beam ends gets no miss from it.
    end.misses = before + weight * (1.0 - e);
    end.hits += weight * e;
  }
}

void CountingMap::add(const PosedScan& scan, const CountingOptions& options, double weight,
                      BeamWeights beams) {
  count(scan, options, weight, beams,
        [&](const CellRect& needed) { cells_.grow(with_room(cells_.rect(), needed)); });
}

void CountingMap::add_tightly(const PosedScan& scan, const CountingOptions& options,
                              BeamWeights beams) {
  count(scan, options, 1.0, beams, [&](const CellRect& needed) { cells_.cover(needed); });
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
