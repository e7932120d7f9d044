// SPDX-License-Identifier: Apache-2.0
#include "core/grid/log_odds_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/config.hpp"
#include "core/grid/count_scans.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata {
namespace {

double log_odds_of(double probability) { return std::log(probability / (1.0 - probability)); }

}  // namespace

LogOddsMap::LogOddsMap(double resolution_m, LogOddsConfig config)
    : config_(config),
      hit_log_odds_(log_odds_of(config.hit_probability)),
      miss_log_odds_(log_odds_of(config.miss_probability)),
      cells_(resolution_m, CellRect{}, 0.0F) {
  require_valid(config, "log_odds_map");
}

void LogOddsMap::change(const Cell& cell, double by) {
  float& value = cells_.at(cell);
  value = static_cast<float>(
      std::clamp(static_cast<double>(value) + by, -config_.clamp_log_odds, config_.clamp_log_odds));
}

void LogOddsMap::add(const PosedScan& scan, const CountingOptions& options) {
  const double resolution = cells_.resolution_m();
  const CellRect extent = extent_of(scan, resolution, options);
  if (extent.empty()) return;
  cells_.grow(with_room(cells_, extent));
  for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t beam, const Ray& ray) {
    const Cell end = cell_at(ray.to_m, resolution);
    traverse_ray(ray.from_m, ray.to_m, resolution, [&](const Cell& cell, double length_m) {
      if (ray.is_hit && cell == end) return;
      change(cell, miss_log_odds_ * length_m / resolution);
    });
    if (!ray.is_hit) return;
    const double e =
        scan.static_probability.empty() ? 1.0 : static_cast<double>(scan.static_probability[beam]);
    change(end, e * hit_log_odds_);
  });
}

ReflectionGrid LogOddsMap::probability() const {
  ReflectionGrid result = make_reflection_grid(cells_.resolution_m(), cells_.rect());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const double value = static_cast<double>(cells_.values()[i]);
    if (value != 0.0) result.values()[i] = static_cast<float>(1.0 / (1.0 + std::exp(-value)));
  }
  return result;
}

}  // namespace strata
