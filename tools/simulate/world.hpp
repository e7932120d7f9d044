// SPDX-License-Identifier: Apache-2.0
/// The true world: what stands where at each moment, and where a ray ends.
///
/// Shares no code with the ray traversal and the sensor models that it tests: rays meet segments
/// and circles in closed form, there is no grid.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/simulate/scenario.hpp"

namespace strata::simulate {

struct Segment {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  double glass_rad = 0.0;  ///< 0: no glass; else only beams so near to its normal return
};

struct Circle {
  Eigen::Vector2d center;
  double radius_m = 0.0;
};

/// Distance along the unit direction to the segment; infinity when the ray misses it. A ray along
/// the segment ends at its nearer end. Glass is met as anything else.
[[nodiscard]] double ray_to_segment(const Eigen::Vector2d& from, const Eigen::Vector2d& direction,
                                    const Segment& segment);
/// Distance to the circle's rim; 0 from inside; infinity when the ray misses it.
[[nodiscard]] double ray_to_circle(const Eigen::Vector2d& from, const Eigen::Vector2d& direction,
                                   const Circle& circle);
/// Whether a beam along the unit direction returns from what it meets.
[[nodiscard]] bool returns_from(const Eigen::Vector2d& direction, const Segment& segment);
[[nodiscard]] double distance_to_segment(const Eigen::Vector2d& point, const Segment& segment);

/// From when on an object is in a state. Times in seconds from the start of that day.
struct StateChange {
  int day = 1;
  double at_s = 0.0;
  std::size_t state = 0;
};

/// A door or a box with the shape it has in each state, and the history of its states.
struct ChangeableObject {
  std::string id;
  std::string kind;  ///< "hinged door", "sliding door" or "box"
  std::vector<std::string> states;
  std::vector<std::vector<Segment>> shapes;  ///< one a state
  std::vector<StateChange> history;          ///< in order; begins at day 1, 0 s

  [[nodiscard]] std::size_t state_at(int day, double time_s) const;
  /// x0, y0, x1, y1 around all that it can cover.
  [[nodiscard]] Eigen::Vector4d bounds() const;
};

/// The still and the changeable parts of a scenario; people are apart (people.hpp).
class World {
 public:
  /// Draws the states that the scenario leaves to chance. day_length_s: for how long a state is
  /// redrawn. Throws ConfigError for a schedule with an unknown state, or two objects of one id.
  World(const ScenarioConfig& scenario, std::uint64_t seed, double day_length_s);

  /// Walls, then from first_block_side on four sides a block.
  [[nodiscard]] const std::vector<Segment>& walls() const { return walls_; }
  [[nodiscard]] std::size_t first_block_side() const { return first_block_side_; }
  [[nodiscard]] const std::vector<ChangeableObject>& objects() const { return objects_; }

 private:
  std::vector<Segment> walls_;
  std::size_t first_block_side_ = 0;
  std::vector<ChangeableObject> objects_;
};

}  // namespace strata::simulate
