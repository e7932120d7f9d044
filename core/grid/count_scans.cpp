// SPDX-License-Identifier: Apache-2.0
#include "core/grid/count_scans.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace strata {
namespace {

constexpr std::size_t kMaxStretches = 8;
constexpr std::size_t kScansPerStretch = 128;  // shorter ones do not pay for their own map
constexpr std::size_t kScansPerRound = 128;    // between two looks at Progress

}  // namespace

CellRect extent_of(const Ray& ray, double resolution_m) {
  const Cell a = cell_at(ray.from_m, resolution_m);
  const Cell b = cell_at(ray.to_m, resolution_m);
  return {{std::min(a.x, b.x), std::min(a.y, b.y)},
          {std::max(a.x, b.x) + 1, std::max(a.y, b.y) + 1}};
}

CellRect extent_of(const PosedScan& scan, double resolution_m, const CountingOptions& options) {
  CellRect extent;
  for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t, const Ray& ray) {
    extent = extent.united(extent_of(ray, resolution_m));
  });
  return extent;
}

CountingMap count_scans(std::span<const PosedScan> scans, double resolution_m,
                        const CountingOptions& options, BeamWeights weights, WorkerPool& pool,
                        Progress* progress) {
  const std::size_t stretches =
      std::clamp(scans.size() / kScansPerStretch, std::size_t{1}, kMaxStretches);
  const std::size_t stretch = (scans.size() + stretches - 1) / stretches;
  auto stretch_begin = [&](std::size_t i) { return std::min(scans.size(), i * stretch); };

  std::vector<CountingMap> partial(stretches, CountingMap(resolution_m));
  pool.for_chunks(stretches, 1, [&](std::size_t i, std::size_t, std::size_t) {
    CellRect extent;
    for (std::size_t k = stretch_begin(i); k < stretch_begin(i + 1); ++k) {
      extent = extent.united(extent_of(scans[k], resolution_m, options));
    }
    partial[i] = CountingMap(Grid<CellCounts>(resolution_m, extent));
  });
  for (std::size_t round = 0; round < stretch; round += kScansPerRound) {
    report_progress(progress, "count beams", round * stretches, stretch * stretches);
    pool.for_chunks(stretches, 1, [&](std::size_t i, std::size_t, std::size_t) {
      const std::size_t end =
          std::min(stretch_begin(i + 1), stretch_begin(i) + round + kScansPerRound);
      for (std::size_t k = stretch_begin(i) + round; k < end; ++k) {
        partial[i].add(scans[k], options, 1.0, weights);
      }
    });
  }
  report_progress(progress, "count beams", scans.size(), scans.size());
  if (stretches == 1) return std::move(partial.front());

  CellRect extent;
  for (const CountingMap& map : partial) extent = extent.united(map.cells().rect());
  Grid<CellCounts> sum(resolution_m, extent);
  for (const CountingMap& map : partial) {
    for (std::size_t i = 0; i < map.cells().size(); ++i) {
      CellCounts& cell = sum.at(map.cells().cell(i));
      cell.hits += map.cells().values()[i].hits;
      cell.misses += map.cells().values()[i].misses;
    }
  }
  return CountingMap(std::move(sum));
}

}  // namespace strata
