// SPDX-License-Identifier: Apache-2.0
#include "core/topology/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "core/grid/counting_map.hpp"
#include "core/grid/distance_field.hpp"

namespace strata::topology {
namespace {

/// Scans kept for the local cloud, at most.
constexpr std::size_t kMaxScans = 60;
constexpr double kTurnRad = 0.35;
/// Poses that the robot has passed are kept this far apart ...
constexpr double kSubsampleM = 0.05;
/// ... over so much way: more than across the free disc of any place and out of it.
constexpr double kMemoryM = 20.0;
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

/// Without those within same_m of one with more room.
std::vector<OpenPlace> roomiest_of(std::vector<OpenPlace> places, double same_m) {
  std::stable_sort(places.begin(), places.end(), [](const OpenPlace& a, const OpenPlace& b) {
    return a.clearance_m > b.clearance_m;
  });
  std::vector<OpenPlace> kept;
  for (const OpenPlace& place : places) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const OpenPlace& other) {
      return (other.at_m - place.at_m).norm() <= same_m;
    });
    if (!known) kept.push_back(place);
  }
  return kept;
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
  options.believes_no_returns = false;  // scans that come over topics do not tell what they say
  for (const PosedScan& scan : recent_) map.add(scan, options);
  const Cell middle = cell_at(robot.translation(), config_.resolution_m);
  const int half = static_cast<int>(config_.radius_m / config_.resolution_m);
  const CellRect rect{{middle.x - half, middle.y - half}, {middle.x + half, middle.y + half}};
  const std::vector<OpenPlace> found = open_places(map.reflection().cropped(rect), config_);
  for (const OpenPlace& place : roomiest_of(found, config_.same_m)) find_again(place);
}

/// What is seen of a place grows until it is left, so its middle moves, and with it what of the way
/// was nearest. Tracks within same_m of what is found are of one landmark.
void LandmarkDetector::find_again(const OpenPlace& place) {
  Track found;
  found.place = place;
  found.from_path_length_m = path_length_m_;
  for (const Track& track : tracks_) {
    if ((track.place.at_m - place.at_m).norm() > config_.same_m) continue;
    found.visited = found.visited || track.visited;
    found.from_path_length_m = std::min(found.from_path_length_m, track.from_path_length_m);
    if (track.reported) found = track;
    if (found.reported) break;
  }
  std::erase_if(tracks_, [&](const Track& track) {
    return (track.place.at_m - place.at_m).norm() <= config_.same_m;
  });
  found.nearest_m = std::numeric_limits<double>::infinity();
  for (const Passed& passed : passed_) {
    if (passed.path_length_m >= found.from_path_length_m) pass(passed, found);
  }
  tracks_.push_back(found);
}

/// The newest pose, and those of the last metres, subsampled.
void LandmarkDetector::remember(const Passed& passed) {
  const std::size_t n = passed_.size();
  if (n >= 2 && passed_[n - 1].path_length_m - passed_[n - 2].path_length_m < kSubsampleM) {
    passed_.pop_back();
  }
  passed_.push_back(passed);
  while (passed.path_length_m - passed_.front().path_length_m > kMemoryM) passed_.pop_front();
}

void LandmarkDetector::pass(const Passed& passed, Track& track) {
  const double distance_m = (passed.at_m - track.place.at_m).norm();
  if (track.reported || (!track.visited && distance_m > track.place.clearance_m)) return;
  if (track.visited && distance_m >= track.nearest_m) return;
  track.visited = true;
  track.nearest_m = distance_m;
  track.path_length_at_nearest_m = passed.path_length_m;
  track.nearest_stamp = passed.stamp;
}

std::vector<LandmarkEvent> LandmarkDetector::add(const PosedScan& scan) {
  const Pose2& robot = scan.map_from_robot;
  if (started_) path_length_m_ += translation_distance(last_, robot);
  const bool moved = !started_ || has_moved(last_detection_, robot, config_.step_m, kTurnRad);
  last_ = robot;
  started_ = true;
  if (moved) {
    last_detection_ = robot;
    recent_.push_back(scan);
    std::erase_if(recent_, [&](const PosedScan& other) {
      return translation_distance(other.map_from_robot, robot) > config_.radius_m;
    });
    if (recent_.size() > kMaxScans) recent_.erase(recent_.begin());
    look_around(robot);
  }
  remember({scan.scan.stamp, robot.translation(), path_length_m_});
  for (Track& track : tracks_) pass(passed_.back(), track);
  std::vector<LandmarkEvent> events;
  for (Track& track : tracks_) {
    if (!track.visited || track.reported) continue;
    if (path_length_m_ - track.path_length_at_nearest_m < config_.leave_m) continue;
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
