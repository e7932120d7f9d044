// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.hpp"

namespace strata::simulate {
namespace {

using report::Color;

/// Where legs end and a body begins, as a share of the height.
constexpr double kLegShare = 0.45;

/// Stripes and squares of about half a metre, so that a camera has something to see.
Color pattern(Color color, double along_m, double up_m) {
  const auto square = static_cast<int>(std::floor(2.0 * along_m) + std::floor(2.0 * up_m));
  const double light = square % 2 == 0 ? 1.0 : 0.82;
  const auto scaled = [&](std::uint8_t c) { return static_cast<std::uint8_t>(light * c); };
  return {scaled(color.r), scaled(color.g), scaled(color.b)};
}

Color color_of(BeamSource source, bool is_low) {
  switch (source) {
    case BeamSource::kPerson:
      return {230, 0, 160};
    case BeamSource::kChangeable:
      return {230, 140, 40};
    default:
      return is_low ? Color{120, 84, 50} : Color{120, 160, 150};
  }
}

/// Whether a point lies between the sides of a convex polygon.
bool is_inside(const std::vector<Segment>& sides, const Eigen::Vector2d& point) {
  bool has_left = false;
  bool has_right = false;
  for (const Segment& side : sides) {
    const Eigen::Vector2d along = side.b - side.a;
    const Eigen::Vector2d to = point - side.a;
    const double turn = along.x() * to.y() - along.y() * to.x();
    has_left = has_left || turn > 0.0;
    has_right = has_right || turn < 0.0;
  }
  return !(has_left && has_right);
}

/// A ray and the best hit so far.
class SpaceRay {
 public:
  SpaceRay(const Eigen::Vector3d& from, const Eigen::Vector3d& direction)
      : from_(from), direction_(direction), level_(direction.head<2>().norm()) {
    // Straight up or down a ray meets no upright face.
    flat_ = level_ > 1e-9 ? Eigen::Vector2d(direction.head<2>() / level_) : Eigen::Vector2d::Zero();
  }

  void meet(const UprightFace& face, double ceiling_m) {
    if (level_ <= 1e-9) return;
    const double range = ray_to_segment(from_.head<2>(), flat_, face.foot) / level_;
    if (!(range < hit_.range_m)) return;
    const Eigen::Vector3d end = from_ + range * direction_;
    if (end.z() < 0.0 || end.z() > face.height_m) return;
    const double along = (end.head<2>() - face.foot.a).norm();
    const bool is_low = face.height_m < ceiling_m;
    hit_ = {range, face.source, pattern(color_of(face.source, is_low), along, end.z())};
  }
  void meet(const UprightCylinder& body) {
    if (level_ <= 1e-9) return;
    const double range = ray_to_circle(from_.head<2>(), flat_, body.foot) / level_;
    if (!(range < hit_.range_m)) return;
    const double z = from_.z() + range * direction_.z();
    if (z < body.from_m || z > body.to_m) return;
    hit_ = {range, BeamSource::kPerson, color_of(BeamSource::kPerson, false)};
  }
  /// sides: empty for a face without end.
  void meet_level(double height_m, const std::vector<Segment>& sides, BeamSource source,
                  Color color) {
    const double range = (height_m - from_.z()) / direction_.z();
    if (!(range > 0.0 && range < hit_.range_m)) return;
    const Eigen::Vector3d end = from_ + range * direction_;
    if (!is_inside(sides, end.head<2>())) return;
    hit_ = {range, source, pattern(color, end.x(), end.y())};
  }
  [[nodiscard]] const SpaceHit& hit() const { return hit_; }

 private:
  Eigen::Vector3d from_;
  Eigen::Vector3d direction_;
  double level_;
  Eigen::Vector2d flat_;
  SpaceHit hit_;
};

}  // namespace

Space make_space(const ScenarioConfig& scenario, std::span<const Segment> still,
                 std::size_t first_block_side, const std::vector<LevelFace>& changeable,
                 std::span<const Circle> legs) {
  const HeightsConfig& heights = scenario.heights;
  Space space;
  space.ceiling_m = heights.ceiling_m;
  for (std::size_t i = 0; i < first_block_side; ++i) {
    space.uprights.push_back({still[i], heights.ceiling_m, BeamSource::kStill});
  }
  for (std::size_t i = 0; i < scenario.blocks.size(); ++i) {
    const double own = scenario.blocks[i].height_m;
    const double height = std::min(own > 0.0 ? own : heights.block_m, heights.ceiling_m);
    const auto sides = still.subspan(first_block_side + 4 * i, 4);
    for (const Segment& side : sides) space.uprights.push_back({side, height, BeamSource::kStill});
    space.levels.push_back({{sides.begin(), sides.end()}, height, BeamSource::kStill});
  }
  for (const LevelFace& shape : changeable) {
    for (const Segment& side : shape.sides) {
      space.uprights.push_back({side, shape.height_m, BeamSource::kChangeable});
    }
    if (shape.sides.size() == 4) space.levels.push_back(shape);
  }
  const double hip_m = kLegShare * heights.person_m;
  for (std::size_t i = 0; i + 1 < legs.size(); i += 2) {
    space.people.push_back({legs[i], 0.0, hip_m});
    space.people.push_back({legs[i + 1], 0.0, hip_m});
    const Eigen::Vector2d middle = 0.5 * (legs[i].center + legs[i + 1].center);
    space.people.push_back({{middle, heights.body_radius_m}, hip_m, heights.person_m});
  }
  return space;
}

SpaceHit first_hit(const Space& space, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& direction) {
  SpaceRay ray(from, direction);
  ray.meet_level(0.0, {}, BeamSource::kStill, {150, 150, 155});
  ray.meet_level(space.ceiling_m, {}, BeamSource::kStill, {235, 235, 225});
  for (const UprightFace& face : space.uprights) ray.meet(face, space.ceiling_m);
  for (const LevelFace& face : space.levels) {
    ray.meet_level(face.height_m, face.sides, face.source, color_of(face.source, true));
  }
  for (const UprightCylinder& body : space.people) ray.meet(body);
  return ray.hit();
}

void scan_layer(const Scanner3Config& scanner, int layer, const Space& space,
                const Pose3& map_from_scanner, double offset_s, RandomStream& random,
                SimulatedCloud& cloud) {
  const double share = scanner.layers > 1 ? static_cast<double>(layer) / (scanner.layers - 1) : 0.5;
  const double elevation =
      degrees_to_radians(scanner.lowest_deg + share * (scanner.highest_deg - scanner.lowest_deg));
  const double field_rad = degrees_to_radians(scanner.field_of_view_deg);
  for (int beam = 0; beam < scanner.beams; ++beam) {
    const double azimuth = field_rad * ((beam + 0.5) / scanner.beams - 0.5);
    // A tilting scanner's plane turns about its y axis; layers are cones.
    const Eigen::Vector3d in_scanner =
        scanner.kind == Scanner3Kind::kTilting
            ? Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth),
                              std::cos(azimuth) * std::sin(elevation))
            : Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                              std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    const SpaceHit hit =
        first_hit(space, map_from_scanner.translation, map_from_scanner.rotation * in_scanner);
    const double noise = random.normal(0.0, scanner.noise_m);
    const bool is_lost =
        random.bernoulli(scanner.drop_probability) || !(hit.range_m < scanner.range_max_m);
    const double range =
        is_lost ? std::numeric_limits<double>::quiet_NaN() : std::max(0.0, hit.range_m + noise);
    cloud.points_m.push_back((in_scanner * range).cast<float>());
    cloud.offset_s.push_back(static_cast<float>(offset_s));
    cloud.sources.push_back(is_lost ? BeamSource::kNothing : hit.source);
  }
}

double focal_pixels(const CameraConfig& camera) {
  return 0.5 * camera.width / std::tan(0.5 * degrees_to_radians(camera.field_of_view_deg));
}

report::Image take_image(const CameraConfig& camera, const Space& space,
                         const Pose3& map_from_camera) {
  report::Image image(camera.width, camera.height);
  const double focal = focal_pixels(camera);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d in_camera((x + 0.5 - 0.5 * camera.width) / focal,
                                      (y + 0.5 - 0.5 * camera.height) / focal, 1.0);
      const Eigen::Vector3d direction = map_from_camera.rotation * in_camera.normalized();
      image.set(x, y, first_hit(space, map_from_camera.translation, direction).color);
    }
  }
  return image;
}

Pose3 robot_from_scanner(const Scanner3Config& scanner) {
  Pose3 pose;
  pose.translation = {scanner.mount_x_m, 0.0, scanner.mount_z_m};
  return pose;
}

Pose3 robot_from_camera(const CameraConfig& camera) {
  Pose3 pose;
  pose.translation = {camera.mount_x_m, 0.0, camera.mount_z_m};
  const double pitch = degrees_to_radians(camera.pitch_deg);
  // Columns: where the camera's right, down and ahead point on the robot.
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(0.0, -1.0, 0.0);
  axes.col(2) = Eigen::Vector3d(std::cos(pitch), 0.0, -std::sin(pitch));
  axes.col(1) = axes.col(2).cross(axes.col(0));
  pose.rotation = Eigen::Quaterniond(axes);
  return pose;
}

}  // namespace strata::simulate
