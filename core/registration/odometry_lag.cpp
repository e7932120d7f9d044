// SPDX-License-Identifier: Apache-2.0
#include "core/registration/odometry_lag.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/geometry/angle.hpp"
#include "core/registration/scan_turn.hpp"

namespace strata::registration {
namespace {

constexpr double kStepS = 0.02;
/// Around the best step; odometry that comes with each scan fits to the millisecond only.
constexpr double kFineReachS = 0.05;
constexpr double kFineStepS = 0.001;
/// Noise of a turn that scans show, and how far off it may be before it counts as an outlier.
constexpr double kTurnNoiseRad = 0.01;
constexpr double kOutlier = 9.0;
/// Longer between two scans, and a turn may have been any.
constexpr double kMaxStepS = 1.0;
constexpr std::size_t kMaxTurns = 20'000;
constexpr std::size_t kParts = 8;
/// A part that turns less tells nothing.
constexpr double kMinTurnedRad = 0.5;
constexpr std::size_t kMinParts = 4;
/// Parts that say the same differ by less; at least such a share of them has to.
constexpr double kSameLagS = 0.15;
constexpr double kMinSame = 0.7;
/// Of the cost of the usual lag.
constexpr double kMaxCostShare = 0.95;
/// The middle deviation of normal noise, in standard deviations.
constexpr double kMiddleOfNormal = 0.6745;

struct Lags {
  double from_s = 0.0;
  double step_s = 0.0;
  std::size_t count = 0;
  [[nodiscard]] double at(std::size_t index) const {
    return from_s + step_s * static_cast<double>(index);
  }
};

Lags around(double middle_s, double reach_s, double step_s) {
  return {middle_s - reach_s, step_s,
          2 * static_cast<std::size_t>(std::lround(reach_s / step_s)) + 1};
}

Lags all_lags() { return around(0.0, kMaxOdometryLagS, kStepS); }

/// A turn that odometry says nothing of at some lag costs there what an outlier does.
void add_costs(const ScanTurn& turn, const OdometryAt& odometry, const Lags& lags,
               std::vector<double>& costs) {
  for (std::size_t k = 0; k < lags.count; ++k) {
    const Duration lag = Duration::from_seconds(lags.at(k));
    const std::optional<Pose2> from = odometry(turn.from + lag);
    const std::optional<Pose2> to = odometry(turn.to + lag);
    if (!from || !to) {
      costs[k] += kOutlier;
      continue;
    }
    const double off =
        angle_difference(angle_difference(to->theta, from->theta), turn.turn_rad) / kTurnNoiseRad;
    costs[k] += std::min(off * off, kOutlier);
  }
}

/// The lag of least cost, between two steps by a parabola.
double best_lag(const std::vector<double>& costs, const Lags& lags) {
  const auto best = std::min_element(costs.begin(), costs.end());
  const double at = lags.at(static_cast<std::size_t>(best - costs.begin()));
  if (best == costs.begin() || std::next(best) == costs.end()) return at;
  const double bend = *std::prev(best) - 2.0 * *best + *std::next(best);
  if (!(bend > 0.0)) return at;
  return at + 0.5 * lags.step_s * (*std::prev(best) - *std::next(best)) / bend;
}

double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Parts that turn alike much.
std::vector<LagPart> parts_of(std::span<const ScanTurn> turns, const OdometryAt& odometry) {
  double turned_rad = 0.0;
  for (const ScanTurn& turn : turns) turned_rad += std::abs(turn.turn_rad);
  std::vector<LagPart> parts(1);
  for (const ScanTurn& turn : turns) {
    if (parts.back().turned_rad >= turned_rad / kParts) parts.emplace_back();
    parts.back().add(turn, odometry);
  }
  return parts;
}

Stamp middle_of_sweep(const Scan& scan) {
  const double sweep_s =
      static_cast<double>(scan.time_increment_s) * static_cast<double>(scan.size() - 1);
  return scan.stamp + Duration::from_seconds(std::isfinite(sweep_s) ? 0.5 * sweep_s : 0.0);
}

}  // namespace

std::vector<ScanTurn> turns_of(std::span<const Scan* const> scans, const ScanTurnConfig& config) {
  std::vector<ScanTurn> turns;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const Scan& before = *scans[i - 1];
    const Scan& now = *scans[i];
    const double step_s = (now.stamp - before.stamp).seconds();
    if (!(step_s > 0.0 && step_s <= kMaxStepS)) continue;
    const std::optional<double> turn = turn_between(before, now, config);
    if (turn) turns.push_back({middle_of_sweep(before), middle_of_sweep(now), *turn});
  }
  return turns;
}

void LagPart::add(const ScanTurn& turn, const OdometryAt& odometry) {
  const Lags lags = all_lags();
  costs.resize(lags.count);
  add_costs(turn, odometry, lags, costs);
  ++turns;
  turned_rad += std::abs(turn.turn_rad);
}

OdometryLag lag_of_parts(std::span<const LagPart> parts) {
  OdometryLag result;
  const Lags lags = all_lags();
  std::vector<double> costs(lags.count, 0.0);
  std::vector<double> of_parts;
  std::size_t turns = 0;
  for (const LagPart& part : parts) {
    if (part.turns == 0) continue;
    for (std::size_t k = 0; k < lags.count; ++k) costs[k] += part.costs[k];
    turns += part.turns;
    if (part.turned_rad >= kMinTurnedRad) of_parts.push_back(best_lag(part.costs, lags));
  }
  if (turns == 0) return result;
  const auto count = static_cast<double>(turns);
  result.cost = *std::min_element(costs.begin(), costs.end()) / count;
  result.cost_without = costs[lags.count / 2] / count;
  if (of_parts.size() < kMinParts) return result;
  const double lag_s = best_lag(costs, lags);
  std::vector<double> off;
  for (const double of_part : of_parts) off.push_back(std::abs(of_part - lag_s));
  const auto same = static_cast<double>(
      std::count_if(off.begin(), off.end(), [](double by) { return by < kSameLagS; }));
  const auto said = static_cast<double>(of_parts.size());
  result.stddev_s = middle_of(off) / kMiddleOfNormal / std::sqrt(said);
  result.certain =
      same >= kMinSame * said && result.cost < kMaxCostShare * middle_of(costs) / count;
  if (result.certain) result.lag_s = lag_s;
  return result;
}

OdometryLag estimate_odometry_lag(std::span<const ScanTurn> turns, const OdometryAt& odometry) {
  if (turns.empty() || !odometry) return {};
  std::vector<ScanTurn> fewer;
  if (turns.size() > kMaxTurns) {
    for (std::size_t i = 0; i < kMaxTurns; ++i) {
      fewer.push_back(turns[i * turns.size() / kMaxTurns]);
    }
    turns = fewer;
  }
  OdometryLag result = lag_of_parts(parts_of(turns, odometry));
  if (!result.certain) return result;
  const Lags near = around(result.lag_s, kFineReachS, kFineStepS);
  std::vector<double> costs(near.count, 0.0);
  for (const ScanTurn& turn : turns) add_costs(turn, odometry, near, costs);
  result.cost = *std::min_element(costs.begin(), costs.end()) / static_cast<double>(turns.size());
  result.lag_s = best_lag(costs, near);
  // Odometry that comes with each scan may fit to the nanosecond only.
  if (result.cost_without <= result.cost) {
    result.cost = result.cost_without;
    result.lag_s = 0.0;
  }
  return result;
}

}  // namespace strata::registration
