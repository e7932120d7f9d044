// SPDX-License-Identifier: Apache-2.0
#include "core/grid/counting_map.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "core/grid/count_scans.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata {

void CountingMap::add(const PosedScan& scan, const CountingOptions& options, double weight,
                      BeamWeights beams) {
  const double resolution = resolution_m();
  std::vector<std::pair<std::size_t, Ray>> rays;
  rays.reserve(scan.scan.size());
  CellRect needed;
  for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t beam, const Ray& ray) {
    rays.emplace_back(beam, ray);
    needed = needed.united(extent_of(ray, resolution));
  });
  if (needed.empty()) return;
  cells_.grow(with_room(cells_, needed));
  const bool weighted =
      beams == BeamWeights::kStaticProbability && !scan.static_probability.empty();
  const double per_cell = weight / resolution;
  std::vector<CellCounts>& counts = cells_.values();
  for (const auto& [beam, ray] : rays) {
    CellCounts& end = counts[cells_.index(cell_at(ray.to_m, resolution))];
    const double before = end.misses;
    traverse_ray(cells_, ray.from_m, ray.to_m, [&](std::size_t index, double length_m) {
      counts[index].misses += per_cell * length_m;
    });
    if (!ray.is_hit) continue;
    const double e = weighted ? static_cast<double>(scan.static_probability[beam]) : 1.0;
    // The cell where the beam ends gets no miss from it.
    end.misses = before + weight * (1.0 - e);
    end.hits += weight * e;
  }
}

ReflectionGrid CountingMap::reflection(double min_evidence) const {
  ReflectionGrid result = make_reflection_grid(resolution_m(), cells_.rect());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const CellCounts& counts = cells_.values()[i];
    if (counts.total() < min_evidence) continue;
    result.values()[i] = static_cast<float>(counts.hits / counts.total());
  }
  return result;
}

}  // namespace strata
