// SPDX-License-Identifier: Apache-2.0
#include "core/slam/surface_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/grid/counting_map.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata::slam {
Eigen::Vector2d SurfaceMap::mean_hit(const Cell& cell, const CellData& data) const {
  const double resolution = cells_.resolution_m();
  return {cell.x * resolution + static_cast<double>(data.sum_x / data.hits),
          cell.y * resolution + static_cast<double>(data.sum_y / data.hits)};
}

registration::NormalScatter SurfaceMap::normal_among(const Cell& cell) const {
  std::vector<Eigen::Vector2d> hits_m;
  for (int y = cell.y - kAmong; y <= cell.y + kAmong; ++y) {
    for (int x = cell.x - kAmong; x <= cell.x + kAmong; ++x) {
      if (!cells_.contains({x, y})) continue;
      const CellData& other = cells_.at({x, y});
      if (is_surface(other)) hits_m.push_back(mean_hit({x, y}, other));
    }
  }
  return registration::normal_of(hits_m);
}

void SurfaceMap::set_point(registration::SurfacePoint& point, const Cell& cell,
                           const CellData& data, const registration::NormalScatter& normals) const {
  const Eigen::Vector2d at = mean_hit(cell, data);
  point.x_m = at.x();
  point.y_m = at.y();
  registration::set_surface_direction(point, normals);
  // Round things have no direction along which they could go on.
  point.slack_m =
      point.tangential < 1.0 ? (1.0 - point.tangential) * static_cast<double>(data.slack_m) : 0.0;
}

void SurfaceMap::add(const Scan& scan, const Pose2& frame_from_laser,
                     std::span<const float> beam_weights, double max_range_m, bool carve) {
  const double resolution = cells_.resolution_m();
  const CountingOptions options{.no_return_free_range_m = 0.0, .max_range_m = max_range_m};
  CellRect needed;
  rays_.clear();
  for_each_ray(scan, frame_from_laser, options, [&](std::size_t beam, const Ray& ray) {
    rays_.emplace_back(beam, ray);
    for (const Eigen::Vector2d& point : {ray.from_m, ray.to_m}) {
      const Cell cell = cell_at(point, resolution);
      needed = needed.united({cell, {cell.x + 1, cell.y + 1}});
    }
  });
  if (needed.empty()) return;
  cells_.grow(with_room(cells_, needed));
  touched_ = touched_.united(needed);
  changed_.clear();
  const Endpoints hits = endpoints_in_robot(scan);
  registration::surfaces_in_sweep(hits, std::abs(static_cast<double>(scan.angle_increment_rad)),
                                  surfaces_);
  std::size_t next_hit = 0;
  // Normals come in the robot frame; n n^T turns with twice the angle.
  const double turn = frame_from_laser.theta - scan.robot_from_laser.theta;
  const double c2 = std::cos(2.0 * turn);
  const double s2 = std::sin(2.0 * turn);
  const auto per_metre = static_cast<float>(1.0 / resolution);
  for (const auto& [beam, ray] : rays_) {
    const Cell end = cell_at(ray.to_m, resolution);
    const std::size_t end_index = cells_.index(end);
    const bool is_hit = ray.is_hit;
    if (carve) {
      traverse_ray(cells_, ray.from_m, ray.to_m, [&](std::size_t index, double length_m) {
        if (is_hit && index == end_index) return;
        CellData& data = cells_.values()[index];
        data.misses += per_metre * static_cast<float>(length_m);
        // Beams that pass change nothing of a point but whether it is still there.
        if (data.point >= 0 && !is_surface(data)) {
          field_.hide(static_cast<std::size_t>(data.point));
        }
      });
    }
    if (!is_hit) continue;
    const float weight = beam_weights.empty() ? 1.0F : beam_weights[beam];
    CellData& data = cells_.values()[end_index];
    data.hits += weight;
    data.misses += 1.0F - weight;
    data.sum_x += weight * static_cast<float>(ray.to_m.x() - end.x * resolution);
    data.sum_y += weight * static_cast<float>(ray.to_m.y() - end.y * resolution);
    while (hits.beam[next_hit] < beam) ++next_hit;
    const registration::NormalScatter& n = surfaces_[next_hit].normal;
    const double difference = 0.5 * static_cast<double>(n.xx - n.yy);
    const double cross = static_cast<double>(n.xy);
    const double mean = 0.5 * static_cast<double>(n.xx + n.yy);
    const double turned = c2 * difference - s2 * cross;
    data.normals.xx += weight * static_cast<float>(mean + turned);
    data.normals.yy += weight * static_cast<float>(mean - turned);
    data.normals.xy += weight * static_cast<float>(s2 * difference + c2 * cross);
    if (weight > 0.0F) data.slack_m = std::min(data.slack_m, surfaces_[next_hit].slack_m);
    changed_.push_back(end);
  }
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  for (const Cell& cell : changed_) refresh(cell);
}

void SurfaceMap::refresh(const Cell& cell) {
  CellData& data = cells_.at(cell);
  bool surface = is_surface(data);
  registration::NormalScatter normals = data.normals;
  if (surface && is_unresolved(data)) {
    normals = normal_among(cell);
    surface = normals.xx + normals.yy > 0.0F;
  }
  if (data.point < 0) {
    if (!surface) return;
    registration::SurfacePoint point;
    set_point(point, cell, data, normals);
    data.point = static_cast<std::int32_t>(field_.add(point));
    return;
  }
  const auto index = static_cast<std::size_t>(data.point);
  registration::SurfacePoint point = field_.points()[index];
  point.occupied = surface;
  if (surface) set_point(point, cell, data, normals);
  field_.set(index, point);
}

SurfaceState SurfaceMap::state(const Eigen::Vector2d& point_m) const {
  const Cell cell = cells_.cell_at(point_m);
  if (!cells_.contains(cell)) return SurfaceState::kUnknown;
  const CellData& data = cells_.at(cell);
  if (data.hits + data.misses < 0.5F) return SurfaceState::kUnknown;
  return is_surface(data) ? SurfaceState::kOccupied : SurfaceState::kFree;
}

bool SurfaceMap::occupied_near(const Eigen::Vector2d& point_m) const {
  return any_beside(cells_.cell_at(point_m), [&](const Cell& cell) {
    return cells_.contains(cell) && is_surface(cells_.at(cell));
  });
}

}  // namespace strata::slam
