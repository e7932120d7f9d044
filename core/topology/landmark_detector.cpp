// SPDX-License-Identifier: Apache-2.0
#include "core/topology/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/distance_field.hpp"

namespace strata::topology {
namespace {

/// Scans kept for the local map, at most.
constexpr std::size_t kMaxScans = 60;
constexpr double kTurnRad = 0.35;
constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// Components of cells that grow as the water falls: each knows its highest cell.
class Islands {
 public:
  explicit Islands(std::size_t cells) : parent_(cells, kNone) {}
  [[nodiscard]] bool has(std::uint32_t cell) const { return parent_[cell] != kNone; }
  void add(std::uint32_t cell) { parent_[cell] = cell; }
  [[nodiscard]] std::uint32_t peak(std::uint32_t cell) {
    while (parent_[cell] != cell) {
      parent_[cell] = parent_[parent_[cell]];
      cell = parent_[cell];
    }
    return cell;
  }
  /// The peak of `lower` now belongs to that of `higher`.
  void join(std::uint32_t lower, std::uint32_t higher) { parent_[lower] = higher; }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::uint32_t> free_cells_by_clearance(const ReflectionGrid& map,
                                                   const DistanceField& clearance_m) {
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (is_free(map.values()[i])) order.push_back(static_cast<std::uint32_t>(i));
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return clearance_m.values()[a] > clearance_m.values()[b];
  });
  return order;
}

}  // namespace

std::vector<OpenPlace> open_places(const ReflectionGrid& map, const LandmarkConfig& config) {
  const DistanceField clearance_m = make_distance_field(map);
  Islands islands(map.size());
  std::vector<bool> at_border(map.size(), false);  // of peaks: their water has run out of the map
  std::vector<OpenPlace> places;
  const auto end = [&](std::uint32_t peak, double level_m) {
    const double height_m = static_cast<double>(clearance_m.values()[peak]);
    if (!std::isfinite(height_m) || height_m < config.min_clearance_m ||
        height_m < config.min_prominence * level_m) {
      return;
    }
    places.push_back({map.center(map.cell(peak)), height_m});
  };
  for (const std::uint32_t i : free_cells_by_clearance(map, clearance_m)) {
    islands.add(i);
    const double level_m = static_cast<double>(clearance_m.values()[i]);
    const Cell cell = map.cell(i);
    bool border = false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell next{cell.x + dx, cell.y + dy};
        if (!map.contains(next) || !is_known(map.at(next))) {
          border = true;
          continue;
        }
        const auto other = static_cast<std::uint32_t>(map.index(next));
        if (!islands.has(other)) continue;
        const std::uint32_t a = islands.peak(i);
        const std::uint32_t b = islands.peak(other);
        if (a == b) continue;
        const bool b_higher = clearance_m.values()[b] > clearance_m.values()[a] ||
                              (clearance_m.values()[b] == clearance_m.values()[a] && b < a);
        const auto [lower, higher] = b_higher ? std::pair(a, b) : std::pair(b, a);
        // Beyond the border there may be more room than anywhere here.
        if (!at_border[lower]) end(lower, level_m);
        if (at_border[lower] && !at_border[higher]) end(higher, level_m);
        at_border[higher] = at_border[higher] || at_border[lower];
        islands.join(lower, higher);
      }
    }
    const std::uint32_t peak = islands.peak(i);
    if (border && !at_border[peak]) {
      end(peak, level_m);
      at_border[peak] = true;
    }
  }
  return places;
}

void LandmarkDetector::look_around(const Pose2& robot) {
  CountingMap map(config_.resolution_m);
  CountingOptions options;
  options.max_range_m = 2.0 * config_.radius_m;
  for (const PosedScan& scan : recent_) map.add(scan, options);
  const Cell middle = cell_at(robot.translation(), config_.resolution_m);
  const int half = static_cast<int>(config_.radius_m / config_.resolution_m);
  const CellRect rect{{middle.x - half, middle.y - half}, {middle.x + half, middle.y + half}};
  for (const OpenPlace& place : open_places(map.reflection().cropped(rect), config_)) {
    const auto known =
        std::min_element(tracks_.begin(), tracks_.end(), [&](const Track& a, const Track& b) {
          return (a.place.at_m - place.at_m).norm() < (b.place.at_m - place.at_m).norm();
        });
    if (known == tracks_.end() || (known->place.at_m - place.at_m).norm() > config_.same_m) {
      tracks_.push_back({place, false, false, 0.0, 0.0, {}});
    } else if (!known->visited) {
      known->place = place;
    }
  }
}

void LandmarkDetector::follow(const PosedScan& scan) {
  for (Track& track : tracks_) {
    const double distance_m = (scan.map_from_robot.translation() - track.place.at_m).norm();
    if (distance_m > track.place.clearance_m || track.reported) continue;
    if (track.visited && distance_m >= track.nearest_m) continue;
    track.visited = true;
    track.nearest_m = distance_m;
    track.way_at_nearest_m = way_m_;
    track.nearest_stamp = scan.scan.stamp;
  }
}

std::vector<LandmarkEvent> LandmarkDetector::add(const PosedScan& scan) {
  const Pose2& robot = scan.map_from_robot;
  if (started_) way_m_ += translation_distance(last_, robot);
  const bool moved = !started_ || translation_distance(last_look_, robot) >= config_.step_m ||
                     std::abs(angle_difference(robot.theta, last_look_.theta)) >= kTurnRad;
  last_ = robot;
  started_ = true;
  if (moved) {
    last_look_ = robot;
    recent_.push_back(scan);
    std::erase_if(recent_, [&](const PosedScan& other) {
      return translation_distance(other.map_from_robot, robot) > config_.radius_m;
    });
    if (recent_.size() > kMaxScans) recent_.erase(recent_.begin());
    look_around(robot);
  }
  follow(scan);
  std::vector<LandmarkEvent> events;
  for (Track& track : tracks_) {
    if (!track.visited || track.reported) continue;
    if (way_m_ - track.way_at_nearest_m < config_.leave_m) continue;
    track.reported = true;
    events.push_back({track.nearest_stamp, track.place.at_m, track.place.clearance_m});
  }
  std::erase_if(tracks_, [&](const Track& track) {
    const double away_m = (robot.translation() - track.place.at_m).norm();
    return away_m > track.place.clearance_m + config_.leave_m &&
           (track.reported || !track.visited) && away_m > config_.radius_m;
  });
  std::sort(events.begin(), events.end(),
            [](const LandmarkEvent& a, const LandmarkEvent& b) { return a.stamp < b.stamp; });
  return events;
}

std::vector<LandmarkEvent> LandmarkDetector::finish() {
  std::vector<LandmarkEvent> events;
  for (Track& track : tracks_) {
    if (!track.visited || track.reported) continue;
    track.reported = true;
    events.push_back({track.nearest_stamp, track.place.at_m, track.place.clearance_m});
  }
  std::sort(events.begin(), events.end(),
            [](const LandmarkEvent& a, const LandmarkEvent& b) { return a.stamp < b.stamp; });
  return events;
}

}  // namespace strata::topology
