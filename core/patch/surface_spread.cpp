// SPDX-License-Identifier: Apache-2.0
#include "core/patch/surface_spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strata::patch {
namespace {

/// Of what passed: far above the few percent of visits that graze, met by beams at 45 degrees.
constexpr double kMostly = 0.5;

}  // namespace

SurfaceSpread::SurfaceSpread(std::span<const Cell> cells) {
  const auto n = static_cast<double>(cells.size());
  double x = 0.0;
  double y = 0.0;
  for (const Cell& cell : cells) {
    x += cell.x / n;
    y += cell.y / n;
  }
  constexpr double kOfASquare = 1.0 / 12.0;
  double xx = kOfASquare;
  double yy = kOfASquare;
  double xy = 0.0;
  for (const Cell& cell : cells) {
    xx += (cell.x - x) * (cell.x - x) / n;
    yy += (cell.y - y) * (cell.y - y) / n;
    xy += (cell.x - x) * (cell.y - y) / n;
  }
  const double mean = 0.5 * (xx + yy);
  const double greatest = mean + std::hypot(0.5 * (xx - yy), xy);
  mean_ = mean / greatest;
  cos2_ = 0.5 * (xx - yy) / greatest;
  sin2_ = xy / greatest;
}

double SurfaceSpread::extent(std::span<const Cell> cells) const {
  const auto width_along = [&](double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const Cell& cell : cells) {
      const double place = c * cell.x + s * cell.y;
      least = std::min(least, place);
      most = std::max(most, place);
    }
    return most - least + std::abs(c) + std::abs(s);  // a cell's own width
  };
  const double longest_rad = 0.5 * std::atan2(sin2_, cos2_);
  return std::max({width_along(longest_rad), width_along(0.0), width_along(std::numbers::pi / 2)});
}

double SurfaceSpread::misses_across(const Visit& visit) const {
  const double across = mean_ * static_cast<double>(visit.misses) -
                        cos2_ * static_cast<double>(visit.passing.cos2) -
                        sin2_ * static_cast<double>(visit.passing.sin2);
  return std::clamp(across, 0.0, static_cast<double>(visit.misses));
}

bool SurfaceSpread::is_crossed_by(const Visit& visit, double min_across) const {
  return misses_across(visit) >= std::min(min_across, kMostly * static_cast<double>(visit.misses));
}

}  // namespace strata::patch
