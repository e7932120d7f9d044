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
  std::vector<const PosedScan*> all;
  all.reserve(scans.size());
  for (const PosedScan& scan : scans) all.push_back(&scan);
  return count_scans(std::span<const PosedScan* const>(all), resolution_m, options, weights, pool,
                     progress);
}

CountingMap count_scans(std::span<const PosedScan* const> scans, double resolution_m,
                        const CountingOptions& options, BeamWeights weights, WorkerPool& pool,
                        Progress* progress) {
  const std::size_t stretches =
      std::clamp(scans.size() / kScansPerStretch, std::size_t{1}, kMaxStretches);
  const std::size_t stretch = (scans.size() + stretches - 1) / stretches;
  auto stretch_begin = [&](std::size_t i) { return std::min(scans.size(), i * stretch); };

  // As many stretches at a time as there are threads, and added in order: no more maps are held.
  const auto at_once = std::min(stretches, static_cast<std::size_t>(pool.threads()));
  CountingMap sum(resolution_m);
  for (std::size_t first = 0; first < stretches; first += at_once) {
    const std::size_t some = std::min(at_once, stretches - first);
    std::vector<CountingMap> partial(some, CountingMap(resolution_m));
    for (std::size_t round = 0; round < stretch; round += kScansPerRound) {
      report_progress(progress, "count beams", stretch_begin(first) + round * some, scans.size());
      pool.for_chunks(some, 1, [&](std::size_t i, std::size_t, std::size_t) {
        const std::size_t begin = stretch_begin(first + i) + round;
        const std::size_t end = std::min(stretch_begin(first + i + 1), begin + kScansPerRound);
        for (std::size_t k = begin; k < end; ++k) {
          partial[i].add_tightly(*scans[k], options, weights);
        }
      });
    }
    if (stretches == 1) sum = std::move(partial.front());
    for (std::size_t i = 0; i < some && stretches > 1; ++i) {
      sum.add(partial[i]);
      partial[i] = CountingMap(resolution_m);
    }
  }
  report_progress(progress, "count beams", scans.size(), scans.size());
  return sum;
}

}  // namespace strata
