// SPDX-License-Identifier: Apache-2.0
/// Scans in saved states (core/base/state_archive.hpp).
#pragma once

#include <type_traits>

#include "core/base/state_archive.hpp"
#include "core/scan/endpoints.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// Of a Scan, a PosedScan or Endpoints, const or not.
template <class Value, class Archive>
requires std::is_same_v<std::remove_const_t<Value>, Scan>
void state_of(Value& scan, Archive& archive) {
  archive(scan.stamp);
  for (auto* value : {&scan.angle_min_rad, &scan.angle_increment_rad, &scan.time_increment_s,
                      &scan.scan_time_s, &scan.range_min_m, &scan.range_max_m}) {
    archive(*value);
  }
  archive(scan.ranges_m);
  archive(scan.robot_from_laser);
}

template <class Value, class Archive>
requires std::is_same_v<std::remove_const_t<Value>, PosedScan>
void state_of(Value& posed, Archive& archive) {
  archive(posed.run);
  archive(posed.map_from_robot);
  archive(posed.static_probability);
  archive(posed.scan);
  if constexpr (Archive::kReads) {
    const std::size_t labels = posed.static_probability.size();
    if (!is_finite(posed.map_from_robot) || !is_finite(posed.scan.robot_from_laser)) {
      archive.fail("has a scan from nowhere");
    }
    if (labels != 0 && labels != posed.scan.size()) archive.fail("has labels of no beams");
  }
}

/// Of a Scan, const or not: what its beams without return say, which `state_of` leaves out.
template <class Value, class Archive>
void no_return_state_of(Value& scan, Archive& archive) {
  archive(scan.free_range_m);
  archive(scan.drop_outs);
  if constexpr (Archive::kReads) {
    if (!(scan.free_range_m >= 0.0F)) archive.fail("has beams that saw less than nothing");
  }
}

template <class Value, class Archive>
requires std::is_same_v<std::remove_const_t<Value>, Endpoints>
void state_of(Value& points, Archive& archive) {
  archive(points.x_m);
  archive(points.y_m);
  archive(points.beam);
  if constexpr (Archive::kReads) {
    const std::size_t count = points.x_m.size();
    if (points.y_m.size() != count || points.beam.size() != count) {
      archive.fail("has points without their coordinates");
    }
  }
}

}  // namespace strata
