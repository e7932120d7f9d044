// SPDX-License-Identifier: Apache-2.0
#include "core/registration/scan_turn.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace strata::registration {
namespace {

constexpr float kNone = -1.0F;

/// Readings of hits; kNone elsewhere.
std::vector<float> hits_of(const Scan& scan) {
  std::vector<float> ranges(scan.size(), kNone);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.kind(i) == BeamKind::kHit) ranges[i] = scan.ranges_m[i];
  }
  return ranges;
}

/// Mean difference where beam i of `now` looks where beam i + shift of `before` did; infinity when
/// less than half of the beams have a partner.
double cost_of(const std::vector<float>& before, const std::vector<float>& now, int shift,
               bool all_round, const ScanTurnConfig& config) {
  const int size = static_cast<int>(now.size());
  float sum = 0.0F;
  int pairs = 0;
  const int step = config.max_beams > 0 ? std::max(1, size / config.max_beams) : 1;
  const auto max_difference_m = static_cast<float>(config.max_difference_m);
  for (int i = 0; i < size; i += step) {
    int other = i + shift;
    if (all_round) other = (other + size) % size;
    if (other < 0 || other >= size) continue;
    const float a = before[static_cast<std::size_t>(other)];
    const float b = now[static_cast<std::size_t>(i)];
    if (a == kNone || b == kNone) continue;
    sum += std::min(std::abs(a - b), max_difference_m);
    ++pairs;
  }
  if (2 * pairs * step < size) return std::numeric_limits<double>::infinity();
  return static_cast<double>(sum) / pairs;
}

}  // namespace

std::optional<double> turn_between(const Scan& before, const Scan& now,
                                   const ScanTurnConfig& config) {
  const auto increment = static_cast<double>(now.angle_increment_rad);
  if (before.size() != now.size() || now.size() < 3 || increment == 0.0 ||
      before.angle_increment_rad != now.angle_increment_rad ||
      before.angle_min_rad != now.angle_min_rad) {
    return std::nullopt;
  }
  const double field = std::abs(increment) * static_cast<double>(now.size());
  const bool all_round = std::abs(field - 2.0 * std::numbers::pi) < 1.5 * std::abs(increment);
  const int reach = std::min(static_cast<int>(config.max_turn_rad / std::abs(increment)),
                             static_cast<int>(now.size()) / 2);
  if (reach < 2) return std::nullopt;
  const std::vector<float> first = hits_of(before);
  const std::vector<float> second = hits_of(now);
  std::vector<double> costs;
  double sum = 0.0;
  int finite = 0;
  for (int shift = -reach; shift <= reach; ++shift) {
    costs.push_back(cost_of(first, second, shift, all_round, config));
    if (std::isfinite(costs.back())) {
      sum += costs.back();
      ++finite;
    }
  }
  const auto best = std::min_element(costs.begin(), costs.end());
  if (finite < 3 || !(*best < config.max_relative_cost * sum / finite)) return std::nullopt;
  // A turn at the end of what was tried may be larger.
  if (best == costs.begin() || best + 1 == costs.end()) return std::nullopt;
  const double bend = *(best - 1) - 2.0 * *best + *(best + 1);
  double between = 0.0;
  if (std::isfinite(bend) && bend > 0.0) between = 0.5 * (*(best - 1) - *(best + 1)) / bend;
  return (static_cast<double>(best - costs.begin()) - reach + between) * increment;
}

}  // namespace strata::registration
