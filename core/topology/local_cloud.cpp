// SPDX-License-Identifier: Apache-2.0
#include "core/topology/local_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Eigenvalues>

namespace strata::topology {

bool is_sound(const LocalCloud& cloud) {
  const auto finite = [](const Eigen::Vector2d& vector) { return vector.allFinite(); };
  return cloud.points_m.size() == cloud.normals.size() &&
         std::all_of(cloud.points_m.begin(), cloud.points_m.end(), finite) &&
         std::all_of(cloud.normals.begin(), cloud.normals.end(), finite);
}

NearestPoint::NearestPoint(const std::vector<Eigen::Vector2d>& points_m, double reach_m)
    : points_m_(points_m), reach_m_(reach_m), cell_m_(reach_m / kCellsPerReach) {
  if (points_m.empty()) return;
  min_ = points_m.front();
  Eigen::Vector2d max = min_;
  for (const Eigen::Vector2d& point : points_m) {
    min_ = min_.cwiseMin(point);
    max = max.cwiseMax(point);
  }
  width_ = static_cast<int>((max.x() - min_.x()) / cell_m_) + 1;
  height_ = static_cast<int>((max.y() - min_.y()) / cell_m_) + 1;
  const auto bucket = [&](const Eigen::Vector2d& point) {
    const int x = static_cast<int>((point.x() - min_.x()) / cell_m_);
    const int y = static_cast<int>((point.y() - min_.y()) / cell_m_);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  };
  begin_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  for (const Eigen::Vector2d& point : points_m) ++begin_[bucket(point) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  order_.resize(points_m.size());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < points_m.size(); ++i) order_[next[bucket(points_m[i])]++] = i;
}

template <typename Visit>
void NearestPoint::for_row(int y, int from_x, int to_x, Visit&& visit) const {
  if (y < 0 || y >= height_) return;
  from_x = std::max(0, from_x);
  to_x = std::min(width_ - 1, to_x);
  if (from_x > to_x) return;
  const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  const std::size_t end = begin_[row + static_cast<std::size_t>(to_x) + 1];
  for (std::size_t k = begin_[row + static_cast<std::size_t>(from_x)]; k < end; ++k) {
    visit(order_[k]);
  }
}

/// The cell of a place; nothing when it is out of everything's reach, or not finite.
std::optional<Eigen::Vector2i> NearestPoint::cell_of(const Eigen::Vector2d& at) const {
  const Eigen::Vector2d place = (at - min_) / cell_m_;
  constexpr double kMargin = kCellsPerReach;
  if (!(place.x() >= -kMargin && place.y() >= -kMargin && place.x() <= width_ + kMargin &&
        place.y() <= height_ + kMargin)) {
    return std::nullopt;
  }
  return Eigen::Vector2i(static_cast<int>(std::floor(place.x())),
                         static_cast<int>(std::floor(place.y())));
}

std::size_t NearestPoint::find(const Eigen::Vector2d& at, double gate_m, std::size_t hint) const {
  const double gate = std::min(gate_m, reach_m_);
  double best = gate * gate;
  std::size_t nearest = kNone;
  const std::optional<Eigen::Vector2i> cell = cell_of(at);
  if (!cell) return kNone;
  const auto try_point = [&](std::size_t i) {
    const double squared = (points_m_[i] - at).squaredNorm();
    if (squared > best || (squared == best && nearest != kNone && i > nearest)) return;
    best = squared;
    nearest = i;
  };
  if (hint != kNone) try_point(hint);
  // Ring after ring of cells, until the next one is further away than the best.
  for (int ring = 0; ring == 0 || (ring - 1) * cell_m_ * (ring - 1) * cell_m_ <= best; ++ring) {
    for (int y = cell->y() - ring; y <= cell->y() + ring; ++y) {
      if (y == cell->y() - ring || y == cell->y() + ring) {
        for_row(y, cell->x() - ring, cell->x() + ring, try_point);
      } else {
        for_row(y, cell->x() - ring, cell->x() - ring, try_point);
        for_row(y, cell->x() + ring, cell->x() + ring, try_point);
      }
    }
  }
  return nearest;
}

void NearestPoint::within(const Eigen::Vector2d& at, std::vector<std::size_t>& found) const {
  found.clear();
  const std::optional<Eigen::Vector2i> cell = cell_of(at);
  if (!cell) return;
  constexpr int kReach = kCellsPerReach + 1;
  for (int y = cell->y() - kReach; y <= cell->y() + kReach; ++y) {
    for_row(y, cell->x() - kReach, cell->x() + kReach, [&](std::size_t i) {
      if ((points_m_[i] - at).squaredNorm() <= reach_m_ * reach_m_) found.push_back(i);
    });
  }
}

PlaceSurface::PlaceSurface(const LocalCloud& cloud, double reach_m)
    : cloud_(cloud), exact_(cloud.points_m, reach_m) {
  if (cloud.empty()) return;
  const auto reach = static_cast<int>(std::ceil(reach_m / kCellM));
  min_ = cloud.points_m.front();
  Eigen::Vector2d max = min_;
  for (const Eigen::Vector2d& point : cloud.points_m) {
    min_ = min_.cwiseMin(point);
    max = max.cwiseMax(point);
  }
  min_ -= Eigen::Vector2d::Constant(reach_m);
  width_ = static_cast<int>((max.x() - min_.x()) / kCellM) + 1 + reach;
  height_ = static_cast<int>((max.y() - min_.y()) / kCellM) + 1 + reach;
  const std::size_t cells = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  nearest_.assign(cells, -1);
  std::vector<double> squared_m(cells, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector2d place = (cloud.points_m[i] - min_) / kCellM;
    const int x = static_cast<int>(place.x());
    const int y = static_cast<int>(place.y());
    for (int cy = std::max(0, y - reach); cy <= std::min(height_ - 1, y + reach); ++cy) {
      for (int cx = std::max(0, x - reach); cx <= std::min(width_ - 1, x + reach); ++cx) {
        const std::size_t cell = static_cast<std::size_t>(cy) * static_cast<std::size_t>(width_) +
                                 static_cast<std::size_t>(cx);
        const double squared = (Eigen::Vector2d(cx + 0.5, cy + 0.5) - place).squaredNorm();
        if (squared >= squared_m[cell]) continue;
        squared_m[cell] = squared;
        nearest_[cell] = static_cast<std::int32_t>(i);
      }
    }
  }
}

LocalCloud with_normals(std::span<const Eigen::Vector2d> points_m, int neighbours) {
  constexpr double kReachM = 1.0;
  std::vector<Eigen::Vector2d> finite;
  for (const Eigen::Vector2d& point : points_m) {
    if (point.allFinite()) finite.push_back(point);
  }
  const NearestPoint nearest(finite, kReachM);
  LocalCloud cloud;
  std::vector<std::size_t> found;
  for (const Eigen::Vector2d& point : finite) {
    nearest.within(point, found);
    if (found.size() < 2) continue;
    const auto distance = [&](std::size_t i) { return (finite[i] - point).squaredNorm(); };
    const std::size_t used =
        std::min(found.size(), static_cast<std::size_t>(neighbours) + 1);  // with itself
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(used), found.end(),
                      [&](std::size_t a, std::size_t b) {
                        return std::pair(distance(a), a) < std::pair(distance(b), b);
                      });
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < used; ++k) mean += finite[found[k]];
    mean /= static_cast<double>(used);
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < used; ++k) {
      const Eigen::Vector2d off = finite[found[k]] - mean;
      scatter += off * off.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(scatter);
    cloud.points_m.push_back(point);
    cloud.normals.push_back(axes.eigenvectors().col(0));
  }
  return cloud;
}

LocalCloud make_local_cloud(std::span<const PosedScan> scans, const Pose2& landmark,
                            const LocalCloudConfig& config) {
  struct Sum {
    Eigen::Vector2d total = Eigen::Vector2d::Zero();
    double count = 0.0;
  };
  std::map<std::pair<int, int>, Sum> cells;  // ordered: the points come out the same everywhere
  for (const PosedScan& posed : scans) {
    const Pose2 landmark_from_robot = between(landmark, posed.map_from_robot);
    if (landmark_from_robot.translation().norm() > config.path_radius_m) continue;
    const Pose2 landmark_from_laser = landmark_from_robot * posed.scan.robot_from_laser;
    for (std::size_t beam = 0; beam < posed.scan.size(); ++beam) {
      if (posed.scan.kind(beam) != BeamKind::kHit) continue;
      const auto range_m = static_cast<double>(posed.scan.ranges_m[beam]);
      const double bearing = posed.scan.bearing_rad(beam);
      const Eigen::Vector2d at = landmark_from_laser * Eigen::Vector2d(range_m * std::cos(bearing),
                                                                       range_m * std::sin(bearing));
      if (!(at.norm() <= config.point_radius_m)) continue;
      Sum& sum = cells[{static_cast<int>(std::floor(at.x() / config.cell_m)),
                        static_cast<int>(std::floor(at.y() / config.cell_m))}];
      sum.total += at;
      sum.count += 1.0;
    }
  }
  std::vector<Eigen::Vector2d> points;
  points.reserve(cells.size());
  for (const auto& [cell, sum] : cells) points.push_back(sum.total / sum.count);
  return with_normals(points, config.neighbours);
}

}  // namespace strata::topology
