// SPDX-License-Identifier: Apache-2.0
#include "core/plan/coarse_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/geometry/angle.hpp"

namespace strata::plan {
namespace {

constexpr double kCell_m = 0.2;
constexpr double kMaxCellsAside = 160.0;
constexpr std::size_t kMaxSamples = 800;
constexpr std::size_t kMaxOfOneTurn = 6;
constexpr double kApart_m = 1.0;
constexpr double kApart_rad = 10.0 * std::numbers::pi / 180.0;
constexpr int kHit = 3;  // of a face in the same cell; 2 and 1 farther off

using Mask = Grid<std::uint8_t>;
using Sums = Grid<std::uint16_t>;

/// Longest side of the box about the faces.
double extent_m(const std::vector<WallFace>& faces) {
  Eigen::Array2d low = faces.front().at_m.array();
  Eigen::Array2d high = low;
  for (const WallFace& face : faces) {
    low = low.min(face.at_m.array());
    high = high.max(face.at_m.array());
  }
  return (high - low).maxCoeff();
}

/// How near a drawn face is, of those that look in a direction or one beside it.
std::array<Mask, kDirections> masks_of(const std::vector<WallFace>& drawn, double cell_m) {
  CellRect rect;
  for (const WallFace& face : drawn) {
    const Cell cell = cell_at(face.at_m, cell_m);
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  rect = rect.inflated(2);
  std::array<Mask, kDirections> masks;
  masks.fill(Mask(cell_m, rect, 0));
  for (const WallFace& face : drawn) {
    const Cell middle = cell_at(face.at_m, cell_m);
    for (const int beside : {-1, 0, 1}) {
      Mask& mask = masks[static_cast<std::size_t>(
          (direction_of(face.normal) + beside + kDirections) % kDirections)];
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const double cells =
              (cell_center({middle.x + dx, middle.y + dy}, cell_m) - face.at_m).norm() / cell_m;
          const int near = cells < 0.75 ? kHit : (cells < 1.25 ? 2 : (cells < 1.75 ? 1 : 0));
          std::uint8_t& value = mask.at({middle.x + dx, middle.y + dy});
          value = std::max(value, static_cast<std::uint8_t>(near));
        }
      }
    }
  }
  return masks;
}

struct Sample {
  Cell cell;
  int direction = 0;
};

std::vector<Sample> turned(const std::vector<WallFace>& seen, double turn_rad, double cell_m) {
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  std::vector<Sample> samples;
  samples.reserve(seen.size());
  for (const WallFace& face : seen) {
    const Eigen::Vector2d at(c * face.at_m.x() - s * face.at_m.y(),
                             s * face.at_m.x() + c * face.at_m.y());
    const Eigen::Vector2d normal(c * face.normal.x() - s * face.normal.y(),
                                 s * face.normal.x() + c * face.normal.y());
    samples.push_back({cell_at(at, cell_m), direction_of(normal)});
  }
  return samples;
}

/// Sums of the masks over the samples, for every shift by whole cells.
Sums sums_of(const std::vector<Sample>& samples, const std::array<Mask, kDirections>& masks) {
  CellRect box;
  for (const Sample& sample : samples) {
    box = box.united({sample.cell, {sample.cell.x + 1, sample.cell.y + 1}});
  }
  const CellRect& rect = masks.front().rect();
  Sums sums(masks.front().resolution_m(),
            {{rect.min.x - box.max.x, rect.min.y - box.max.y},
             {rect.max.x - box.min.x, rect.max.y - box.min.y}},
            0);
  for (const Sample& sample : samples) {
    const Mask& mask = masks[static_cast<std::size_t>(sample.direction)];
    const auto width = static_cast<std::size_t>(mask.width());
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      const std::uint8_t* from = &mask.at({rect.min.x, y});
      std::uint16_t* to = &sums.at({rect.min.x - sample.cell.x, y - sample.cell.y});
      for (std::size_t x = 0; x < width; ++x) to[x] = static_cast<std::uint16_t>(to[x] + from[x]);
    }
  }
  return sums;
}

bool is_apart(const CoarsePlace& a, const CoarsePlace& b) {
  return translation_distance(a.plan_from_map, b.plan_from_map) > kApart_m ||
         std::abs(angle_difference(a.plan_from_map.theta, b.plan_from_map.theta)) > kApart_rad;
}

/// Those that no better one is near to, best first.
std::vector<CoarsePlace> best_of(std::vector<CoarsePlace> places, std::size_t count) {
  std::stable_sort(places.begin(), places.end(),
                   [](const CoarsePlace& a, const CoarsePlace& b) { return a.score > b.score; });
  std::vector<CoarsePlace> kept;
  for (const CoarsePlace& place : places) {
    if (kept.size() == count) break;
    const auto is_far = [&](const CoarsePlace& other) { return is_apart(place, other); };
    if (std::all_of(kept.begin(), kept.end(), is_far)) kept.push_back(place);
  }
  return kept;
}

std::vector<CoarsePlace> places_of(const Sums& sums, double turn_rad, std::size_t samples,
                                   const std::optional<CoarseGuess>& guess) {
  const std::uint16_t most = *std::max_element(sums.values().begin(), sums.values().end());
  std::vector<CoarsePlace> places;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const int sum = sums.values()[i];
    if (sum * 10 < most * 7 && !guess) continue;
    const Eigen::Vector2d at =
        sums.resolution_m() * Eigen::Vector2d(sums.cell(i).x, sums.cell(i).y);
    if (guess && (at - guess->plan_from_map.translation()).norm() > guess->radius_m) continue;
    places.push_back({{at.x(), at.y(), turn_rad}, sum / (kHit * static_cast<double>(samples))});
  }
  return best_of(std::move(places), kMaxOfOneTurn);
}

}  // namespace

Eigen::Vector2d middle_of(const std::vector<WallFace>& faces) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const WallFace& face : faces) sum += face.at_m;
  return faces.empty() ? sum : Eigen::Vector2d(sum / static_cast<double>(faces.size()));
}

std::vector<CoarsePlace> coarse_places(const std::vector<WallFace>& seen,
                                       const std::vector<WallFace>& drawn, std::size_t count,
                                       const std::optional<CoarseGuess>& guess) {
  if (seen.empty() || drawn.empty()) return {};
  const double cell_m =
      std::max(kCell_m, std::max(extent_m(seen), extent_m(drawn)) / kMaxCellsAside);
  const Eigen::Vector2d middle = middle_of(seen);
  std::vector<WallFace> faces = thinned(seen, cell_m);
  for (WallFace& face : faces) face.at_m -= middle;
  const std::size_t step = (faces.size() + kMaxSamples - 1) / kMaxSamples;
  std::vector<WallFace> some;
  for (std::size_t i = 0; i < faces.size(); i += step) some.push_back(faces[i]);
  double farthest_m = cell_m;
  for (const WallFace& face : some) farthest_m = std::max(farthest_m, face.at_m.norm());
  const auto masks = masks_of(drawn, cell_m);
  const int turns = static_cast<int>(std::ceil(2.0 * std::numbers::pi * farthest_m / cell_m));
  std::vector<CoarsePlace> all;
  for (int i = 0; i < turns; ++i) {
    const double turn = wrap_angle(2.0 * std::numbers::pi * i / turns);
    if (guess && std::abs(angle_difference(turn, guess->plan_from_map.theta)) >
                     guess->radius_rad + cell_m / farthest_m) {
      continue;
    }
    const Sums sums = sums_of(turned(some, turn, cell_m), masks);
    const auto found = places_of(sums, turn, some.size(), guess);
    all.insert(all.end(), found.begin(), found.end());
  }
  return best_of(std::move(all), count);
}

}  // namespace strata::plan
