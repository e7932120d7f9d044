// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/grid/ray_traversal.hpp"

namespace strata::beam_filter {

double expectation(double reflection, double prior) {
  const double by_static = prior * reflection;
  return by_static / (by_static + (1.0 - prior) * (1.0 - reflection));
}

double em_step(double reflection, const CellCounts& counts_at_e1, double prior) {
  return counts_at_e1.hits * expectation(reflection, prior) / counts_at_e1.total();
}

double closed_form(const CellCounts& counts_at_e1, double prior, double min_evidence) {
  // Written so that a NaN total is unknown too.
  if (!(counts_at_e1.total() >= min_evidence)) return std::numeric_limits<double>::quiet_NaN();
  const double ratio = counts_at_e1.hits / counts_at_e1.total();
  return std::clamp((prior * ratio + prior - 1.0) / (2.0 * prior - 1.0), 0.0, 1.0);
}

double critical_ratio(double prior) { return (1.0 - prior) / prior; }

double log_beam_likelihood(const Ray& ray, bool is_static, const ReflectionGrid& map) {
  const double resolution = map.resolution_m();
  const Cell end = map.cell_at(ray.to_m);
  double sum = 0.0;
  traverse_ray(ray.from_m, ray.to_m, resolution, [&](const Cell& cell, double length_m) {
    const float value = map.get(cell);
    if (!is_known(value)) return;
    const double m = std::clamp(static_cast<double>(value), kLogMargin, 1.0 - kLogMargin);
    if (ray.is_hit && cell == end) {
      sum += std::log(is_static ? m : 1.0 - m);
    } else {
      sum += length_m / resolution * std::log(1.0 - m);
    }
  });
  return sum;
}

}  // namespace strata::beam_filter
