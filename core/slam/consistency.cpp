// SPDX-License-Identifier: Apache-2.0
#include "core/slam/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata::slam {
namespace {

constexpr double kResolutionM = 0.1;
constexpr double kStretchM = 8.0;
constexpr double kMaxRangeM = 8.0;
/// A scan is drawn when the robot has gone or turned so far since the last that was.
constexpr double kStepM = 0.2;
constexpr double kStepRad = 0.15;
/// In front of a hit: a grazing beam ends beside its wall.
constexpr double kMarginM = 0.2;
/// A surface within so many cells of the other's fits it.
constexpr int kToleranceCells = 3;
constexpr std::uint8_t kMinCellHits = 2;
constexpr std::uint8_t kMinCellSeen = 3;
constexpr std::size_t kMinCells = 60;
/// Chosen on Freiburg 079, Intel, Wean Hall, the museum and CSAIL at reference poses, at those of
/// SLAM and at odometry's: at good poses at most 0.7% of the pairs are above it, at odometry's 20%
/// and more (docs/theory/slam.md, "Consistency").
constexpr double kMaxShare = 0.4;
/// So many pairs, and so large a share of all: one alone may be a room that was refurnished.
constexpr std::size_t kMinContradicting = 2;
constexpr double kMinContradictingShare = 0.01;
/// ... and of the pairs of one run with others, for that run alone to be held to contradict them.
constexpr std::size_t kMinContradictingOfRun = 4;
constexpr double kMinContradictingShareOfRun = 0.1;
constexpr double kOnePlaceM = 5.0;

struct Stretch {
  std::size_t begin = 0;  ///< of the scans
  std::size_t end = 0;
};

/// What a stretch saw.
struct Sight {
  enum State : std::uint8_t { kUnknown, kFree, kNearSurface };
  Grid<std::uint8_t> state;
  std::vector<Cell> surface;
};

/// Consecutive scans of one run, by length of the way.
std::vector<Stretch> stretches_of(std::span<const PosedScan> scans) {
  std::vector<Stretch> stretches;
  double way_m = 0.0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const bool same_run = i > 0 && scans[i].run == scans[i - 1].run;
    if (same_run)
      way_m += translation_distance(scans[i - 1].map_from_robot, scans[i].map_from_robot);
    if (!same_run || way_m >= kStretchM) {
      stretches.push_back({i, i});
      way_m = 0.0;
    }
    stretches.back().end = i + 1;
  }
  return stretches;
}

bool is_worth_drawing(const std::optional<Pose2>& last, const Pose2& pose) {
  return !last || translation_distance(*last, pose) >= kStepM ||
         std::abs(angle_difference(last->theta, pose.theta)) >= kStepRad;
}

struct Counts {
  Grid<std::uint8_t> hits;
  Grid<std::uint8_t> seen;  ///< passed through
};

void count_one(std::uint8_t& count) {
  if (count < 255) ++count;
}

void draw(const PosedScan& posed, Counts& counts) {
  const Pose2 map_from_laser = posed.map_from_laser();
  const Eigen::Vector2d from(map_from_laser.x, map_from_laser.y);
  for (std::size_t i = 0; i < posed.scan.size(); ++i) {
    if (posed.scan.kind(i) != BeamKind::kHit) continue;
    const auto range_m = static_cast<double>(posed.scan.ranges_m[i]);
    const double angle = map_from_laser.theta + posed.scan.bearing_rad(i);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const bool dynamic =
        !posed.static_probability.empty() && is_dynamic(posed.static_probability[i]);
    const double free_m = std::min(range_m - kMarginM, kMaxRangeM);
    if (free_m > 0.0) {
      traverse_ray(from, from + free_m * direction, kResolutionM,
                   [&](const Cell& cell, double /*length_m*/) {
                     if (counts.seen.contains(cell)) count_one(counts.seen.at(cell));
                   });
    }
    if (range_m > kMaxRangeM || dynamic) continue;
    const Cell hit = cell_at(from + range_m * direction, kResolutionM);
    if (counts.hits.contains(hit)) count_one(counts.hits.at(hit));
  }
}

Sight sight_of(std::span<const PosedScan> scans) {
  CellRect rect;
  for (const PosedScan& posed : scans) {
    const Cell at = cell_at({posed.map_from_robot.x, posed.map_from_robot.y}, kResolutionM);
    rect = rect.united({at, {at.x + 1, at.y + 1}});
  }
  rect = rect.inflated(static_cast<int>(kMaxRangeM / kResolutionM) + kToleranceCells + 1);
  Counts counts{Grid<std::uint8_t>(kResolutionM, rect), Grid<std::uint8_t>(kResolutionM, rect)};
  std::optional<Pose2> last;
  for (const PosedScan& posed : scans) {
    if (!is_worth_drawing(last, posed.map_from_robot)) continue;
    last = posed.map_from_robot;
    draw(posed, counts);
  }
  Sight sight{Grid<std::uint8_t>(kResolutionM, rect), {}};
  for (std::size_t i = 0; i < counts.seen.size(); ++i) {
    const Cell cell = counts.seen.cell(i);
    const std::uint8_t hits = counts.hits.at(cell);
    const std::uint8_t seen = counts.seen.at(cell);
    if (hits >= kMinCellHits && hits >= seen / 2) {
      sight.surface.push_back(cell);
    } else if (hits == 0 && seen >= kMinCellSeen) {
      sight.state.at(cell) = Sight::kFree;
    }
  }
  for (const Cell& cell : sight.surface) {
    for (int dy = -kToleranceCells; dy <= kToleranceCells; ++dy) {
      for (int dx = -kToleranceCells; dx <= kToleranceCells; ++dx) {
        const Cell near{cell.x + dx, cell.y + dy};
        if (sight.state.contains(near)) sight.state.at(near) = Sight::kNearSurface;
      }
    }
  }
  return sight;
}

/// Cells with a surface by one stretch that the other knows.
struct Tally {
  std::size_t fitting = 0;
  std::size_t against = 0;
  Eigen::Vector2d fitting_m = Eigen::Vector2d::Zero();  ///< sum of their centres
  Eigen::Vector2d against_m = Eigen::Vector2d::Zero();

  void add(const Sight& surfaces, const Sight& other) {
    for (const Cell& cell : surfaces.surface) {
      const std::uint8_t state = other.state.get(cell);
      if (state == Sight::kUnknown) continue;
      const bool is_free = state == Sight::kFree;
      ++(is_free ? against : fitting);
      (is_free ? against_m : fitting_m) += cell_center(cell, kResolutionM);
    }
  }
  [[nodiscard]] std::size_t cells() const { return fitting + against; }
  [[nodiscard]] Eigen::Vector2d middle_m() const {
    if (against > 0) return against_m / static_cast<double>(against);
    return fitting_m / static_cast<double>(fitting);
  }
};

ComparedStretches told(const Tally& tally, const PosedScan& first, const PosedScan& second) {
  const Eigen::Vector2d middle_m = tally.middle_m();
  ComparedStretches pair;
  pair.x_m = middle_m.x();
  pair.y_m = middle_m.y();
  pair.first_run = first.run;
  pair.second_run = second.run;
  pair.first = first.scan.stamp;
  pair.second = second.scan.stamp;
  pair.cells = tally.cells();
  pair.share = static_cast<double>(tally.against) / static_cast<double>(pair.cells);
  return pair;
}

/// In ascending order. Where a run contradicts so much that the others do, too, by it, it alone is
/// named: the one with the greatest share comes first and its pairs are counted no more.
std::vector<int> runs_against_others(std::vector<ComparedStretches> pairs) {
  std::erase_if(pairs, [](const auto& pair) { return pair.first_run == pair.second_run; });
  std::vector<int> found;
  while (true) {
    std::map<int, std::pair<std::size_t, std::size_t>> of_run;  // contradicting, compared
    for (const ComparedStretches& pair : pairs) {
      for (const int run : {pair.first_run, pair.second_run}) {
        of_run[run].first += pair.share > kMaxShare ? 1 : 0;
        ++of_run[run].second;
      }
    }
    const auto share = [](const auto& counts) {
      return static_cast<double>(counts.first) / static_cast<double>(counts.second);
    };
    const auto worst =
        std::max_element(of_run.begin(), of_run.end(), [&](const auto& a, const auto& b) {
          // Of two alike the later run.
          return std::pair(share(a.second), a.first) < std::pair(share(b.second), b.first);
        });
    if (worst == of_run.end() || worst->second.first < kMinContradictingOfRun ||
        share(worst->second) < kMinContradictingShareOfRun) {
      break;
    }
    const int run = worst->first;
    found.push_back(run);
    std::erase_if(pairs, [&](const ComparedStretches& pair) {
      return pair.first_run == run || pair.second_run == run;
    });
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::vector<ComparedStretches> compare_stretches(std::span<const PosedScan> scans,
                                                 WorkerPool& pool) {
  const std::vector<Stretch> stretches = stretches_of(scans);
  std::vector<Sight> sights(stretches.size());
  pool.for_chunks(stretches.size(), 1, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      sights[i] =
          sight_of(scans.subspan(stretches[i].begin, stretches[i].end - stretches[i].begin));
    }
  });
  std::vector<std::vector<ComparedStretches>> of_first(stretches.size());
  const auto middle = [&](std::size_t i) -> const PosedScan& {
    return scans[(stretches[i].begin + stretches[i].end) / 2];
  };
  pool.for_chunks(stretches.size(), 1, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = i + 1; j < stretches.size(); ++j) {
        if (sights[i].state.rect().intersected(sights[j].state.rect()).empty()) continue;
        Tally tally;
        tally.add(sights[i], sights[j]);
        tally.add(sights[j], sights[i]);
        if (tally.cells() >= kMinCells) of_first[i].push_back(told(tally, middle(i), middle(j)));
      }
    }
  });
  std::vector<ComparedStretches> all;
  for (auto& pairs : of_first) all.insert(all.end(), pairs.begin(), pairs.end());
  return all;
}

Consistency check_consistency(std::span<const PosedScan> scans, WorkerPool& pool) {
  std::vector<ComparedStretches> pairs = compare_stretches(scans, pool);
  Consistency result;
  result.compared = pairs.size();
  for (const ComparedStretches& pair : pairs) {
    const auto against =
        static_cast<std::size_t>(std::lround(pair.share * static_cast<double>(pair.cells)));
    result.contradicting_cells += against;
    result.fitting_cells += pair.cells - against;
  }
  result.against_others = runs_against_others(pairs);
  std::erase_if(pairs, [](const ComparedStretches& pair) { return pair.share <= kMaxShare; });
  result.contradicting = pairs.size();
  const bool are_few = pairs.size() < kMinContradicting ||
                       static_cast<double>(pairs.size()) <
                           kMinContradictingShare * static_cast<double>(result.compared);
  result.consistent = are_few && result.against_others.empty();
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
  for (const ComparedStretches& pair : pairs) {
    const bool is_told = std::any_of(
        result.places.begin(), result.places.end(), [&](const ComparedStretches& place) {
          return std::hypot(place.x_m - pair.x_m, place.y_m - pair.y_m) < kOnePlaceM;
        });
    if (!is_told) result.places.push_back(pair);
  }
  return result;
}

}  // namespace strata::slam
