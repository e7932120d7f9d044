// SPDX-License-Identifier: Apache-2.0
/// One sweep of a planar laser scanner, at wire precision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"

namespace strata {

/// What a reading says, after REP 117.
enum class BeamKind : std::uint8_t {
  kHit,       ///< finite, within [range_min, range_max]
  kNoReturn,  ///< +Inf, or at or above range_limit_m(range_max): nothing seen
  kTooClose,  ///< -Inf, or below range_min (negative values too)
  kInvalid,   ///< NaN
};

/// The same numbers as sensor_msgs/LaserScan plus the mounting, so that a log read twice, or
/// through DDS, carries the same bits. Beam i points at angle_min + i * angle_increment in the
/// laser frame, counter-clockwise positive. Readers turn a scanner's no-return codes into +Inf.
struct Scan {
  Stamp stamp;
  float angle_min_rad = 0.0F;
  float angle_increment_rad = 0.0F;
  float time_increment_s = 0.0F;
  float scan_time_s = 0.0F;
  float range_min_m = 0.0F;
  float range_max_m = 0.0F;
  std::vector<float> ranges_m;
  /// Where the laser sits on the robot (base_link).
  Pose2 robot_from_laser;
  /// So far a beam without return saw nothing; 0: it says nothing. Found from many scans
  /// (core/scan/drop_outs.hpp), neither sent nor saved.
  float free_range_m = 0.0F;
  /// Beams that say nothing all the same, in order: their return dropped out, or may have.
  std::vector<std::uint32_t> drop_outs;

  [[nodiscard]] std::size_t size() const { return ranges_m.size(); }
  [[nodiscard]] double bearing_rad(std::size_t beam) const {
    return static_cast<double>(angle_min_rad) +
           static_cast<double>(beam) * static_cast<double>(angle_increment_rad);
  }
  [[nodiscard]] BeamKind kind(std::size_t beam) const;
};

/// A scan with the odometry of its moment: what a robot hands over, before any estimate.
struct Observation {
  int run = 0;  ///< which recorded run it belongs to; stamps of two runs may overlap
  Scan scan;
  Pose2 odom_from_robot;  ///< odometry at the scan's stamp; identity when has_odometry is false
  bool has_odometry = true;
};

/// Whether a beam of that static probability is held to have hit something that moves.
[[nodiscard]] inline bool is_dynamic(float static_probability) { return static_probability < 0.5F; }

/// A scan with the pose that mapping gave it and what the beam filter thinks of each beam.
struct PosedScan {
  int run = 0;
  Scan scan;
  Pose2 map_from_robot;
  /// P(beam caused by something static) per beam, e(t,n) of [stachniss2003chapter] eq. (1.10).
  /// Empty: not estimated, count every beam fully.
  std::vector<float> static_probability;

  [[nodiscard]] Pose2 map_from_laser() const { return map_from_robot * scan.robot_from_laser; }
};

/// How many beams are of each kind.
struct BeamCounts {
  std::size_t hits = 0;
  std::size_t no_returns = 0;
  std::size_t too_close = 0;
  std::size_t invalid = 0;
};
[[nodiscard]] BeamCounts count_beams(const Scan& scan);

}  // namespace strata
