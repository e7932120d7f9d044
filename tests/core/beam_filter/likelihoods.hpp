// SPDX-License-Identifier: Apache-2.0
/// Likelihoods of beams and maps, written down as the paper has them: what the filter must climb.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/beam_filter/beam_model.hpp"
#include "core/beam_filter/config.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata::beam_filter {

/// (1 - p) / p: cells hit by at most this share of their beams become free.
inline double critical_ratio(double prior) { return (1.0 - prior) / prior; }

inline double clamped(float m) {
  return std::clamp(static_cast<double>(m), kLogMargin, 1.0 - kLogMargin);
}

/// ln p(z | c, x, m) of [stachniss2003chapter] eq. (1.1) with beams weighted by length,
/// (1 - m)^l: unknown cells say nothing. The end cell of a ray without a hit says nothing if the
/// ray stands for a maximum range reading of the paper; here such a ray stands for free space up to
/// its end, so the end cell counts like the others. [nats]. O(cells the ray crosses).
inline double log_beam_likelihood(const Ray& ray, bool is_static, const ReflectionGrid& map) {
  const double resolution = map.resolution_m();
  const Cell end = map.cell_at(ray.to_m);
  double sum = 0.0;
  traverse_ray(ray.from_m, ray.to_m, resolution, [&](const Cell& cell, double length_m) {
    const float value = map.get(cell);
    if (!is_known(value)) return;
    const double m = clamped(value);
    if (ray.is_hit && cell == end) {
      sum += std::log(is_static ? m : 1.0 - m);
    } else {
      sum += length_m / resolution * std::log(1.0 - m);
    }
  });
  return sum;
}

/// ln P(end in a cell | m) with c summed out; 0 where nothing is known. The cell's own reflection
/// decides, or the greatest known one around it.
inline double log_end_in(const ReflectionGrid& map, const Cell& cell,
                         const BeamFilterConfig& config) {
  float best = map.get(cell);
  const int reach = config.endpoint_tolerance ? 1 : 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const float value = map.get({cell.x + dx, cell.y + dy});
      if (value > best || !is_known(best)) best = value;
    }
  }
  if (!is_known(best)) return 0.0;
  return std::log((1.0 - config.prior) + (2.0 * config.prior - 1.0) * clamped(best));
}

/// l of [stachniss2003chapter] eq. (1.5) at a map: sum over beams of the log likelihood with the
/// labels summed out, from counts with every beam static. Unknown cells say nothing. [nats].
/// O(cells).
inline double incomplete_log_likelihood(const CountingMap& raw, const ReflectionGrid& map,
                                        const BeamFilterConfig& config) {
  double sum = 0.0;
  for (std::size_t i = 0; i < raw.cells().size(); ++i) {
    const CellCounts& counts = raw.cells().get(raw.cells().cell(i));
    if (counts.hits == 0.0 && counts.misses == 0.0) continue;
    const Cell cell = raw.cells().cell(i);
    if (const float m = map.get(cell); is_known(m))
      sum += counts.misses * std::log(1.0 - clamped(m));
    if (counts.hits != 0.0) sum += counts.hits * log_end_in(map, cell, config);
  }
  return sum;
}

/// ... beam by beam. O(beams x cells a beam crosses).
inline double incomplete_log_likelihood(std::span<const PosedScan> scans, const ReflectionGrid& map,
                                        const BeamFilterConfig& config) {
  double sum = 0.0;
  for (const PosedScan& scan : scans) {
    for_each_ray(scan.scan, scan.map_from_laser(), config.counting,
                 [&](std::size_t, const Ray& ray) {
                   const Cell end = map.cell_at(ray.to_m);
                   traverse_ray(ray.from_m, ray.to_m, map.resolution_m(),
                                [&](const Cell& cell, double inside) {
                                  const float m = map.get(cell);
                                  if ((ray.is_hit && cell == end) || !is_known(m)) return;
                                  sum += inside / map.resolution_m() * std::log(1.0 - clamped(m));
                                });
                   if (ray.is_hit) sum += log_end_in(map, end, config);
                 });
  }
  return sum;
}

}  // namespace strata::beam_filter
