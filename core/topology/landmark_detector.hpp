// SPDX-License-Identifier: Apache-2.0
/// Junctions and the middles of rooms, from the map of what was just seen.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::topology {

struct LandmarkConfig {
  double radius_m = 6.0;
  double resolution_m = 0.05;
  double step_m = 0.3;
  double min_clearance_m = 0.5;
  double min_prominence = 1.12;
  double same_m = 1.5;
  double leave_m = 3.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("radius_m", c.radius_m,
            {.doc = "half the side of the map that landmarks are looked for in, around the robot",
             .unit = "m",
             .min = 1.0});
    v.field("resolution_m", c.resolution_m, {.doc = "its cells", .unit = "m", .min = 0.01});
    v.field("step_m", c.step_m,
            {.doc = "scans this far apart make it, and it is looked at that often",
             .unit = "m",
             .min = 0.05});
    v.field("min_clearance_m", c.min_clearance_m,
            {.doc = "no landmark nearer to a surface than this", .unit = "m", .min = 0.1});
    v.field("min_prominence", c.min_prominence,
            {.doc = "a landmark has more room around it than the narrowest place on the way to the "
                    "next, by this factor; lower finds more",
             .min = 1.0});
    v.field("same_m", c.same_m,
            {.doc = "two findings within this distance are one landmark", .unit = "m", .min = 0.1});
    v.field("leave_m", c.leave_m,
            {.doc = "a landmark can be visited again after the robot was this far beyond its walls",
             .unit = "m",
             .min = 0.5});
  }
};

/// A place with more room around it than the ways that lead to it.
struct OpenPlace {
  Eigen::Vector2d at_m{0.0, 0.0};
  double clearance_m = 0.0;
};

/// Maxima of the distance to the nearest surface over the free cells of a map, those that stand
/// out: the way from one to anything with more room, or to the border of what is known, leads
/// through a place narrower by min_prominence. Crossings of corridors of width w have 1.41 times
/// the room of the corridors, branchings 1.25, corners 1.17; rooms much more than their doors. Of
/// equals the first in the grid. O(cells log cells).
[[nodiscard]] std::vector<OpenPlace> open_places(const ReflectionGrid& map,
                                                 const LandmarkConfig& config);

/// The robot was at a landmark.
struct LandmarkEvent {
  Stamp stamp;               ///< when it came nearest
  Eigen::Vector2d center_m;  ///< in the frame of the scans' poses
  double clearance_m = 0.0;
};

/// Follows one run. What is seen of a place grows until it is left: its middle is that of the last
/// look at it, so that it is the same whichever way the robot came. Of findings within same_m of
/// each other the one with most room counts. Not thread-safe, two objects are independent.
class LandmarkDetector {
 public:
  explicit LandmarkDetector(const LandmarkConfig& config) : config_(config) {}

  /// scan: the next one, its map_from_robot in any frame that is right over some metres. Returns
  /// the landmarks that the robot has now passed: it was inside of the free disc around them and
  /// has come away from the point nearest to the centre by config.leave_m. O(cells of the local
  /// map) every step_m.
  [[nodiscard]] std::vector<LandmarkEvent> add(const PosedScan& scan);
  /// Landmarks visited and not yet left.
  [[nodiscard]] std::vector<LandmarkEvent> finish();

 private:
  struct Track {
    OpenPlace place;
    bool visited = false;
    bool reported = false;
    double from_path_length_m = 0.0;  // where it was first found
    double nearest_m = 0.0;
    double path_length_at_nearest_m = 0.0;
    Stamp nearest_stamp;
  };
  struct Passed {
    Stamp stamp;
    Eigen::Vector2d at_m{0.0, 0.0};
    double path_length_m = 0.0;
  };
  void look_around(const Pose2& robot);
  void find_again(const OpenPlace& place);
  void remember(const Passed& passed);
  static void pass(const Passed& passed, Track& track);
  LandmarkConfig config_;
  std::vector<PosedScan> recent_;
  std::vector<Track> tracks_;
  std::deque<Passed> passed_;
  bool started_ = false;
  Pose2 last_;
  Pose2 last_detection_;
  double path_length_m_ = 0.0;
};

}  // namespace strata::topology
