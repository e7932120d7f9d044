// SPDX-License-Identifier: Apache-2.0
#include "tools/site/map_shift.hpp"

#include <cmath>
#include <cstdint>

#include "core/geometry/angle.hpp"
#include "core/registration/correlative_search.hpp"
#include "core/registration/match_field.hpp"
#include "core/registration/scan_matcher.hpp"

namespace strata::site {
namespace {

constexpr std::size_t kMaxPoints = 4000;
/// What a wrong start of a mapper leaves; a greater one shows in the walls that are common.
constexpr registration::SearchWindow kWindow{0.5, 0.5, 0.05};
constexpr double kMinScore = 0.3;
/// A shift that explains so little more than none is none: repeated walls fit in several places.
constexpr double kMinGain = 0.02;

/// Walls where the other map knows something, seen from `origin`: a turn is about there.
Endpoints walls_of(const ReflectionGrid& map, const ReflectionGrid& known_in,
                   const Eigen::Vector2d& origin_m) {
  Endpoints walls;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_occupied(map.values()[i]) || !is_known(known_in.get(map.cell(i)))) continue;
    const Eigen::Vector2d at = map.center(map.cell(i)) - origin_m;
    walls.x_m.push_back(at.x());
    walls.y_m.push_back(at.y());
    walls.beam.push_back(static_cast<std::uint32_t>(walls.beam.size()));
  }
  return walls;
}

Eigen::Vector2d middle_of(const Endpoints& walls) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < walls.size(); ++i) {
    sum += Eigen::Vector2d(walls.x_m[i], walls.y_m[i]);
  }
  return walls.size() == 0 ? sum : Eigen::Vector2d(sum / static_cast<double>(walls.size()));
}

}  // namespace

double known_share(const ReflectionGrid& of, const ReflectionGrid& in) {
  std::size_t known = 0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (!is_known(of.values()[i])) continue;
    ++known;
    if (is_known(in.get(of.cell(i)))) ++common;
  }
  return known == 0 ? 1.0 : static_cast<double>(common) / static_cast<double>(known);
}

MapShift map_shift(const ReflectionGrid& fixed, const ReflectionGrid& moved) {
  MapShift shift;
  const Eigen::Vector2d middle = middle_of(walls_of(moved, fixed, Eigen::Vector2d::Zero()));
  const Endpoints walls = subsample(walls_of(moved, fixed, middle), kMaxPoints);
  const registration::MatchField field(
      fixed, {.occupied_reflection = static_cast<double>(kOccupiedReflection)});
  if (walls.size() == 0 || field.points().empty()) return shift;
  const Pose2 start{middle.x(), middle.y(), 0.0};
  registration::MatchConfig config;
  config.effective_beams = static_cast<double>(walls.size());
  registration::MatchResult best = registration::match(walls, {}, field, start, nullptr, config);
  const registration::CorrelativeTables tables(field, {});
  const auto found = registration::search(walls, tables, start, kWindow, kMinScore);
  if (found.found) {
    const auto other = registration::match(walls, {}, field, found.pose, nullptr, config);
    if (other.inlier_share > best.inlier_share + kMinGain) best = other;
  }
  shift.from_moved = best.pose * inverse(start);
  shift.shift_m = translation_distance(best.pose, start);
  shift.turn_rad = std::abs(wrap_angle(best.pose.theta));
  shift.common_walls = best.inlier_share;
  shift.converged = best.converged;
  return shift;
}

}  // namespace strata::site
