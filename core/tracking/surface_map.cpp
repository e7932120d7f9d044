// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/surface_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/grid/counting_map.hpp"
#include "core/grid/tiled_traversal.hpp"

namespace strata::slam {
Eigen::Vector2d SurfaceMap::mean_hit(const Cell& cell, const HitCell& data) const {
  const double resolution = cells_.resolution_m();
  return {cell.x * resolution + static_cast<double>(data.sum_x / data.hits),
          cell.y * resolution + static_cast<double>(data.sum_y / data.hits)};
}

registration::NormalScatter SurfaceMap::normal_among(const Cell& cell) const {
  std::vector<Eigen::Vector2d> hits_m;
  for (int y = cell.y - kAmong; y <= cell.y + kAmong; ++y) {
    for (int x = cell.x - kAmong; x <= cell.x + kAmong; ++x) {
      const HitCell* other = hit_cell({x, y});
      if (other != nullptr && is_surface(*other)) hits_m.push_back(mean_hit({x, y}, *other));
    }
  }
  return registration::normal_of(hits_m);
}

void SurfaceMap::set_point(registration::SurfacePoint& point, const Cell& cell, const HitCell& data,
                           const registration::NormalScatter& normals) const {
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
  const CountingOptions options{.max_range_m = max_range_m, .believes_no_returns = false};
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
  cells_.cover(needed);
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
  for (const auto& [beam, ray] : rays_) {
    if (carve) carve_ray(ray);
    if (!ray.is_hit) continue;
    while (hits.beam[next_hit] < beam) ++next_hit;
    const Cell end = cell_at(ray.to_m, resolution);
    add_hit(end, ray.to_m, beam_weights.empty() ? 1.0F : beam_weights[beam], surfaces_[next_hit],
            c2, s2);
    changed_.push_back(end);
  }
  if (!has_field_) return;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  for (const Cell& cell : changed_) refresh(cell);
}

void SurfaceMap::carve_ray(const Ray& ray) {
  const auto per_metre = static_cast<float>(1.0 / cells_.resolution_m());
  const Code* end = ray.is_hit ? &cells_.at(cell_at(ray.to_m, cells_.resolution_m())) : nullptr;
  traverse_ray(cells_, ray.from_m, ray.to_m, [&](Code& code, double length_m) {
    if (&code == end) return;
    const float misses = per_metre * static_cast<float>(length_m);
    if (!is_hit(code)) {
      code = code_of(misses_of(code) + misses);
      return;
    }
    HitCell& data = hit_cells_[index_of(code)];
    data.misses += misses;
    // Beams that pass change nothing of a point but whether it is still there.
    if (data.point >= 0 && !is_surface(data)) field_.hide(static_cast<std::size_t>(data.point));
  });
}

void SurfaceMap::add_hit(const Cell& cell, const Eigen::Vector2d& at_m, float weight,
                         const registration::SweepSurface& surface, double c2, double s2) {
  const double resolution = cells_.resolution_m();
  HitCell& data = begin_hit_cell(cells_.at(cell));
  data.hits += weight;
  data.misses += 1.0F - weight;
  data.sum_x += weight * static_cast<float>(at_m.x() - cell.x * resolution);
  data.sum_y += weight * static_cast<float>(at_m.y() - cell.y * resolution);
  const registration::NormalScatter& n = surface.normal;
  const double difference = 0.5 * static_cast<double>(n.xx - n.yy);
  const double cross = static_cast<double>(n.xy);
  const double mean = 0.5 * static_cast<double>(n.xx + n.yy);
  const double turned = c2 * difference - s2 * cross;
  data.normals.xx += weight * static_cast<float>(mean + turned);
  data.normals.yy += weight * static_cast<float>(mean - turned);
  data.normals.xy += weight * static_cast<float>(s2 * difference + c2 * cross);
  if (weight > 0.0F) data.slack_m = std::min(data.slack_m, surface.slack_m);
}

SurfaceMap::HitCell& SurfaceMap::begin_hit_cell(Code& code) {
  if (!is_hit(code)) {
    HitCell data;
    data.misses = misses_of(code);
    hit_cells_.push_back(data);  // first: where memory runs out, no cell may name it
    code = ~static_cast<Code>(hit_cells_.size() - 1);
  }
  return hit_cells_[index_of(code)];
}

void SurfaceMap::reserve(const CellRect& rect) {
  if (rect.empty()) return;
  cells_.cover(rect);
  const double resolution = cells_.resolution_m();
  field_.reserve(cell_center(rect.min, resolution),
                 cell_center({rect.max.x - 1, rect.max.y - 1}, resolution));
}

void SurfaceMap::forget_counts() {
  cells_ = TiledGrid<Code>(cells_.resolution_m());
  hit_cells_ = {};
  field_.forget_distances();
}

Grid<SurfaceMap::HitCell> SurfaceMap::saved_cells() const {
  Grid<HitCell> saved(cells_.resolution_m(), cells_.rect());
  cells_.visit_rows([&](const Cell& first, std::span<const Code> row) {
    HitCell* cells = &saved.at(first);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (is_hit(row[i])) {
        cells[i] = hit_cells_[index_of(row[i])];
      } else {
        cells[i].misses = misses_of(row[i]);
      }
    }
  });
  return saved;
}

void SurfaceMap::restore_cells(const Grid<HitCell>& saved) {
  cells_ = TiledGrid<Code>(saved.resolution_m(), saved.rect());
  hit_cells_.clear();
  for (std::size_t i = 0; i < saved.size(); ++i) {
    const HitCell& cell = saved.values()[i];
    HitCell passed;
    passed.misses = cell.misses;
    if (std::memcmp(&cell, &passed, sizeof cell) == 0 && !std::signbit(cell.misses)) {
      if (cell.misses != 0.0F) cells_.at(saved.cell(i)) = code_of(cell.misses);
    } else {
      begin_hit_cell(cells_.at(saved.cell(i))) = cell;
    }
  }
}

std::optional<registration::NormalScatter> SurfaceMap::normals_of(const Cell& cell,
                                                                  const HitCell& data) const {
  if (!is_surface(data)) return std::nullopt;
  if (!is_unresolved(data)) return data.normals;
  const registration::NormalScatter normals = normal_among(cell);
  if (!(normals.xx + normals.yy > 0.0F)) return std::nullopt;
  return normals;
}

std::vector<registration::SurfacePoint> SurfaceMap::surfaces() const {
  std::vector<registration::SurfacePoint> points;
  cells_.visit_rows([&](const Cell& first, std::span<const Code> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!is_hit(row[i])) continue;
      const Cell cell{first.x + static_cast<int>(i), first.y};
      const HitCell& data = hit_cells_[index_of(row[i])];
      const auto normals = normals_of(cell, data);
      if (normals) set_point(points.emplace_back(), cell, data, *normals);
    }
  });
  return points;
}

void SurfaceMap::refresh(const Cell& cell) {
  HitCell& data = hit_cells_[index_of(cells_.get(cell))];
  const auto normals = normals_of(cell, data);
  if (data.point < 0) {
    if (!normals) return;
    registration::SurfacePoint point;
    set_point(point, cell, data, *normals);
    data.point = static_cast<std::int32_t>(field_.add(point));
    return;
  }
  const auto index = static_cast<std::size_t>(data.point);
  registration::SurfacePoint point = field_.points()[index];
  point.occupied = normals.has_value();
  if (normals) set_point(point, cell, data, *normals);
  field_.set(index, point);
}

SurfaceState SurfaceMap::state(const Eigen::Vector2d& point_m) const {
  const Cell cell = cell_at(point_m, cells_.resolution_m());
  const Code code = cells_.get(cell);
  if (!is_hit(code)) return misses_of(code) < 0.5F ? SurfaceState::kUnknown : SurfaceState::kFree;
  const HitCell& data = hit_cells_[index_of(code)];
  if (data.hits + data.misses < 0.5F) return SurfaceState::kUnknown;
  return is_surface(data) ? SurfaceState::kOccupied : SurfaceState::kFree;
}

bool SurfaceMap::occupied_near(const Eigen::Vector2d& point_m) const {
  return any_beside(cell_at(point_m, cells_.resolution_m()), [&](const Cell& cell) {
    const HitCell* hit = hit_cell(cell);
    return hit != nullptr && is_surface(*hit);
  });
}

}  // namespace strata::slam
