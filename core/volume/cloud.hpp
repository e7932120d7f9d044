// SPDX-License-Identifier: Apache-2.0
/// One 3-D scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"
#include "core/volume/rgb.hpp"

namespace strata::volume {

/// Points of a cloud that were measured at about the same moment.
struct CloudPart {
  std::size_t begin = 0;  ///< place of its first point; it reaches up to the next part
  Stamp stamp;
  Pose3 map_from_sensor;
};

struct Cloud {
  Stamp stamp;
  Pose3 map_from_sensor;
  std::vector<Eigen::Vector3f> points_m;  ///< in the sensor's frame of their moment; may hold NaN
  /// Empty: all points were measured at `stamp`, or nothing finer is known. Else in order, the
  /// first begins at 0.
  std::vector<CloudPart> parts;
  /// How long measuring took about `stamp` where no part tells; 0: a moment.
  double sweep_s = 0.0;
  /// What a simulator says of the points: 1 on something that moves. Empty: nothing is known.
  std::vector<std::uint8_t> truly_moving;
  /// One a point. Empty: nothing is known.
  std::vector<Rgb> colors;
};

/// The parts of a cloud; one when it has none of its own.
[[nodiscard]] std::vector<CloudPart> parts_of(const Cloud& cloud);
/// Where part i of a cloud ends.
[[nodiscard]] inline std::size_t end_of_part(const Cloud& cloud,
                                             const std::vector<CloudPart>& parts, std::size_t i) {
  return i + 1 < parts.size() ? parts[i + 1].begin : cloud.points_m.size();
}

/// Where the sensor was at a moment; nothing when that is not known.
using SensorPoses = std::function<std::optional<Pose3>(Stamp)>;

/// Cuts a cloud that was measured while sensor or robot moved into parts of part_s seconds, each
/// with the pose of its middle; points are brought into the order of the parts. offset_s: when each
/// point was measured, after the cloud's stamp [s]; one beyond 10,000 s or not finite counts as 0.
/// Points of parts without pose are left out. Returns how many. Requires one offset a point and
/// part_s > 0. O(points log points + parts x poses).
std::size_t cut_by_time(Cloud& cloud, std::span<const float> offset_s, double part_s,
                        const SensorPoses& poses);

}  // namespace strata::volume
