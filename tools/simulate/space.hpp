// SPDX-License-Identifier: Apache-2.0
/// What stands in space at one moment of a scenario, where a ray ends in it, and what sees it.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose3.hpp"
#include "core/random/stream.hpp"
#include "tools/report/image.hpp"
#include "tools/simulate/laser.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::simulate {

/// An upright wall from the floor.
struct UprightFace {
  Segment foot;
  double height_m = 0.0;
  BeamSource source = BeamSource::kStill;
};
/// A level face with four sides.
struct LevelFace {
  std::vector<Segment> sides;
  double height_m = 0.0;
  BeamSource source = BeamSource::kStill;
};
/// An upright cylinder without lids: a leg, a body.
struct UprightCylinder {
  Circle foot;
  double from_m = 0.0;
  double to_m = 0.0;
};

/// Floor, ceiling and all that stands between them.
struct Space {
  double ceiling_m = 2.6;
  std::vector<UprightFace> uprights;
  std::vector<LevelFace> levels;
  std::vector<UprightCylinder> people;
};

struct SpaceHit {
  double range_m = std::numeric_limits<double>::infinity();
  BeamSource source = BeamSource::kNothing;
  report::Color color;  ///< of what is there, for cameras
};

/// still: the walls of a world, the sides of blocks from first_block_side on. legs: two circles a
/// person.
[[nodiscard]] Space make_space(const ScenarioConfig& scenario, std::span<const Segment> still,
                               std::size_t first_block_side,
                               const std::vector<LevelFace>& changeable,
                               std::span<const Circle> legs);

/// Where a ray along a unit direction ends. O(faces + people).
[[nodiscard]] SpaceHit first_hit(const Space& space, const Eigen::Vector3d& from,
                                 const Eigen::Vector3d& direction);

/// A cloud with the truth of each point. Points without return are NaN.
struct SimulatedCloud {
  Stamp stamp;                            ///< of its first layer
  std::vector<Eigen::Vector3f> points_m;  ///< in the scanner's frame of their moment
  std::vector<float> offset_s;            ///< when each was measured, after the stamp
  std::vector<BeamSource> sources;
};

/// Adds the points of layer `layer` of a cloud, measured from one pose. offset_s: after the cloud's
/// stamp. O(beams x faces).
void scan_layer(const Scanner3Config& scanner, int layer, const Space& space,
                const Pose3& map_from_scanner, double offset_s, RandomStream& random,
                SimulatedCloud& cloud);

struct SimulatedImage {
  Stamp stamp;
  report::Image image{1, 1};
};

/// Focal length in pixels; the principal point is the middle, and there is no distortion.
[[nodiscard]] double focal_pixels(const CameraConfig& camera);

/// Through a pinhole. The camera's frame is optical: x right, y down, z ahead. O(pixels x faces).
[[nodiscard]] report::Image take_image(const CameraConfig& camera, const Space& space,
                                       const Pose3& map_from_camera);

/// How the scanner and the camera sit on the robot.
[[nodiscard]] Pose3 robot_from_scanner(const Scanner3Config& scanner);
[[nodiscard]] Pose3 robot_from_camera(const CameraConfig& camera);

}  // namespace strata::simulate
