// SPDX-License-Identifier: Apache-2.0
#include "core/volume/dynamic_boxes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/scan/endpoints.hpp"

namespace strata::volume {
namespace {

/// The root of an element's tree, which it shortens on the way.
std::size_t root_of(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<DynamicPoint> dynamic_points(std::span<const PosedScan> scans) {
  std::vector<DynamicPoint> points;
  for (const PosedScan& scan : scans) {
    const Endpoints ends = endpoints_in_robot(scan.scan);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const std::size_t beam = ends.beam[i];
      if (beam >= scan.static_probability.size() || !is_dynamic(scan.static_probability[beam]))
        continue;
      const Eigen::Vector2d in_robot(ends.x_m[i], ends.y_m[i]);
      points.push_back({scan.scan.stamp, scan.map_from_robot * in_robot});
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const DynamicPoint& a, const DynamicPoint& b) { return a.stamp < b.stamp; });
  return points;
}

DynamicBoxes::DynamicBoxes(const DynamicBoxConfig& config, std::vector<DynamicPoint> points)
    : config_(config), points_(std::move(points)) {
  require_valid(config, "boxes");
}

std::vector<DynamicBox> DynamicBoxes::at(Stamp stamp, double longer_s) const {
  const Duration window = Duration::from_seconds(config_.window_s + longer_s);
  const auto before = [](const DynamicPoint& point, Stamp s) { return point.stamp < s; };
  const auto after = [](Stamp s, const DynamicPoint& point) { return s < point.stamp; };
  const auto begin = std::lower_bound(points_.begin(), points_.end(), stamp - window, before);
  const auto end = std::upper_bound(begin, points_.end(), stamp + window, after);
  const auto count = static_cast<std::size_t>(end - begin);
  const auto place = [&](std::size_t i) {
    return (begin + static_cast<std::ptrdiff_t>(i))->place_m;
  };
  std::vector<std::size_t> parents(count);
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((place(i) - place(j)).squaredNorm() > config_.link_m * config_.link_m) continue;
      parents[root_of(parents, i)] = root_of(parents, j);
    }
  }
  std::vector<DynamicBox> boxes(count);
  std::vector<int> sizes(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t root = root_of(parents, i);
    const bool is_first = sizes[root]++ == 0;
    boxes[root].low_m = is_first ? place(i) : boxes[root].low_m.cwiseMin(place(i)).eval();
    boxes[root].high_m = is_first ? place(i) : boxes[root].high_m.cwiseMax(place(i)).eval();
  }
  std::vector<DynamicBox> kept;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(config_.margin_m);
  for (std::size_t i = 0; i < count; ++i) {
    if (sizes[i] < config_.min_points) continue;
    kept.push_back({boxes[i].low_m - margin, boxes[i].high_m + margin});
  }
  return kept;
}

std::vector<std::uint8_t> DynamicBoxes::label(const Cloud& cloud) const {
  std::vector<std::uint8_t> is_dynamic(cloud.points_m.size(), 0);
  const std::vector<CloudPart> parts = parts_of(cloud);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const std::vector<DynamicBox> boxes =
        at(parts[part].stamp, cloud.parts.empty() ? 0.5 * cloud.sweep_s : 0.0);
    if (boxes.empty()) continue;
    const Pose3& map_from_sensor = parts[part].map_from_sensor;
    for (std::size_t i = parts[part].begin; i < end_of_part(cloud, parts, part); ++i) {
      const Eigen::Vector3d p = map_from_sensor * cloud.points_m[i].cast<double>().eval();
      if (!(p.z() >= config_.lowest_m && p.z() <= config_.highest_m)) continue;
      const auto holds = [&](const DynamicBox& box) {
        return p.x() >= box.low_m.x() && p.x() <= box.high_m.x() && p.y() >= box.low_m.y() &&
               p.y() <= box.high_m.y();
      };
      is_dynamic[i] = std::any_of(boxes.begin(), boxes.end(), holds) ? 1 : 0;
    }
  }
  return is_dynamic;
}

}  // namespace strata::volume
