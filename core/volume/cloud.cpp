// SPDX-License-Identifier: Apache-2.0
#include "core/volume/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strata::volume {
namespace {

/// No cloud takes hours: what is further off is damage, as what is not finite.
constexpr float kFarthestOffset_s = 1e4F;

}  // namespace

std::vector<CloudPart> parts_of(const Cloud& cloud) {
  if (!cloud.parts.empty()) return cloud.parts;
  return {{0, cloud.stamp, cloud.map_from_sensor}};
}

std::size_t cut_by_time(Cloud& cloud, std::span<const float> offset_s, double part_s,
                        const SensorPoses& poses) {
  const std::size_t count = cloud.points_m.size();
  std::vector<std::pair<double, std::size_t>> order(count);  // part, a whole number; point
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_sound = std::abs(offset_s[i]) <= kFarthestOffset_s;  // not so for NaN
    const double offset = is_sound ? static_cast<double>(offset_s[i]) : 0.0;
    order[i] = {std::floor(offset / part_s), i};
  }
  std::sort(order.begin(), order.end());
  const bool has_truth = cloud.truly_moving.size() == count;
  std::vector<Eigen::Vector3f> points;
  const bool has_colors = cloud.colors.size() == count;
  std::vector<std::uint8_t> truly_moving;
  std::vector<Rgb> colors;
  points.reserve(count);
  cloud.parts.clear();
  cloud.sweep_s = 0.0;
  for (std::size_t begin = 0; begin < count;) {
    const double number = order[begin].first;
    std::size_t end = begin;
    while (end < count && order[end].first == number) ++end;
    const double middle_s = (number + 0.5) * part_s;
    const Stamp stamp = cloud.stamp + Duration::from_seconds(middle_s);
    if (const auto pose = poses(stamp)) {
      cloud.parts.push_back({points.size(), stamp, *pose});
      for (std::size_t i = begin; i < end; ++i) {
        points.push_back(cloud.points_m[order[i].second]);
        if (has_truth) truly_moving.push_back(cloud.truly_moving[order[i].second]);
        if (has_colors) colors.push_back(cloud.colors[order[i].second]);
      }
    }
    begin = end;
  }
  cloud.points_m = std::move(points);
  cloud.truly_moving = std::move(truly_moving);
  cloud.colors = std::move(colors);
  if (!cloud.parts.empty()) {
    const CloudPart& middle = cloud.parts[cloud.parts.size() / 2];
    cloud.stamp = middle.stamp;
    cloud.map_from_sensor = middle.map_from_sensor;
  }
  return count - cloud.points_m.size();
}

}  // namespace strata::volume
