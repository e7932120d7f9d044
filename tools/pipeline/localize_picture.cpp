// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using report::Color;

constexpr int kMapPixels = 1400;
constexpr Color kNone{200, 30, 30};
constexpr Color kHalf{235, 180, 0};
constexpr Color kAll{0, 150, 80};
constexpr Color kUnknownThere{40, 110, 200};
constexpr Color kAmbiguous{150, 60, 190};

std::uint8_t between(std::uint8_t from, std::uint8_t to, double share) {
  return static_cast<std::uint8_t>(std::lround(from + share * (to - from)));
}

Color between(const Color& from, const Color& to, double share) {
  return {between(from.r, to.r, share), between(from.g, to.g, share), between(from.b, to.b, share)};
}

/// What is known, and where the robot was taken to be.
CellRect shown_rect(const ReflectionGrid& map, const LogFit& fit) {
  CellRect rect = report::known_rect(map);
  for (const FittedScan& scan : fit.scans) {
    const Cell cell{static_cast<int>(std::floor(scan.map_from_robot.x / map.resolution_m())),
                    static_cast<int>(std::floor(scan.map_from_robot.y / map.resolution_m()))};
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  return rect;
}

}  // namespace

Color color_of(const FittedScan& scan) {
  if (scan.is_ambiguous) return kAmbiguous;
  if (scan.fit == FitState::kUnknown) return kUnknownThere;
  const double score = std::clamp(scan.score, 0.0, 1.0);
  return score < 0.5 ? between(kNone, kHalf, 2.0 * score) : between(kHalf, kAll, 2.0 * score - 1.0);
}

void write_trajectory_picture(const std::filesystem::path& folder, const ReflectionGrid& map,
                              const LogFit& fit) {
  report::MapPicture picture = report::draw_map(map, shown_rect(map, fit), kMapPixels);
  for (const FittedScan& scan : fit.scans) {
    const Eigen::Vector2i at = picture.pixel(scan.map_from_robot.translation());
    picture.image.dot(at.x(), at.y(), 1, color_of(scan));
  }
  for (const Pose2& place : fit.places) {
    const Eigen::Vector2i at = picture.pixel(place.translation());
    picture.image.dot(at.x(), at.y(), 4, kAmbiguous);
  }
  report::write_file(folder / kTrajectoryPicture, report::encode_png(picture.image));
}

}  // namespace strata::pipeline
