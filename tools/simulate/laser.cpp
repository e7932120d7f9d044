// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"

namespace strata::simulate {
namespace {

struct FirstHit {
  double range_m = std::numeric_limits<double>::infinity();
  BeamSource source = BeamSource::kNothing;

  void offer(double range, BeamSource of) {
    if (range < range_m) *this = {range, of};
  }
};

FirstHit first_hit(const Eigen::Vector2d& from, double angle, const Surroundings& world) {
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  FirstHit hit;
  for (const Segment& s : world.still) {
    if (!returns_from(direction, s)) continue;
    hit.offer(ray_to_segment(from, direction, s), BeamSource::kStill);
  }
  for (const Segment& s : world.changeable) {
    hit.offer(ray_to_segment(from, direction, s), BeamSource::kChangeable);
  }
  for (const Circle& c : world.people) {
    hit.offer(ray_to_circle(from, direction, c), BeamSource::kPerson);
  }
  return hit;
}

}  // namespace

Pose2 robot_from_laser(const LaserConfig& config) {
  return {config.mount_x_m, config.mount_y_m,
          wrap_angle(degrees_to_radians(config.mount_theta_deg))};
}

TrueScan take_scan(const LaserConfig& config, const Pose2& map_from_laser,
                   const Surroundings& surroundings, RandomStream& random) {
  const double wedge_rad = degrees_to_radians(config.field_of_view_deg) / config.beams;
  TrueScan result;
  Scan& scan = result.scan;
  scan.angle_min_rad =
      static_cast<float>(-0.5 * degrees_to_radians(config.field_of_view_deg) + 0.5 * wedge_rad);
  scan.angle_increment_rad = static_cast<float>(wedge_rad);
  scan.scan_time_s = static_cast<float>(1.0 / config.rate_hz);
  scan.range_min_m = static_cast<float>(config.range_min_m);
  scan.range_max_m = static_cast<float>(config.range_max_m);
  scan.robot_from_laser = robot_from_laser(config);
  const auto beams = static_cast<std::size_t>(config.beams);
  scan.ranges_m.reserve(beams);
  result.sources.reserve(beams);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    // Always the same draws a beam, so that changing one beam's fate leaves the others alone.
    const double noise = random.normal();
    const bool dropped = random.bernoulli(config.drop_probability);
    const bool outlier = random.bernoulli(config.outlier_probability);
    const double outlier_share = random.uniform();
    FirstHit hit = first_hit(map_from_laser.translation(),
                             map_from_laser.theta + scan.bearing_rad(beam), surroundings);
    double range = hit.range_m + config.noise_m * noise;
    if (outlier) {
      range = outlier_share * std::min(hit.range_m, config.range_max_m);
      hit.source = BeamSource::kOutlier;
    }
    range = std::max(range, config.range_min_m);
    if (dropped || !(range < config.range_max_m)) {
      scan.ranges_m.push_back(std::numeric_limits<float>::infinity());
      result.sources.push_back(BeamSource::kNothing);
    } else {
      scan.ranges_m.push_back(static_cast<float>(range));
      result.sources.push_back(hit.source);
    }
  }
  return result;
}

}  // namespace strata::simulate
