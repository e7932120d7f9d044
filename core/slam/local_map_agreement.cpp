// SPDX-License-Identifier: Apache-2.0
#include "core/slam/local_map_agreement.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace strata::slam {

double breadth_m(const Endpoints& view) {
  if (view.size() == 0) return 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Eigen::Vector2d at(view.x_m[i], view.y_m[i]);
    sum += at;
    squares += at * at.transpose();
  }
  const auto count = static_cast<double>(view.size());
  const Eigen::Vector2d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
      squares / count - mean * mean.transpose(), Eigen::EigenvaluesOnly);
  return std::sqrt(2.0 * std::max(0.0, axes.eigenvalues()(0)));
}

registration::MatchField field_of(const LocalMap& local_map, double resolution_m,
                                  const registration::MatchFieldConfig& config) {
  registration::MatchField field(resolution_m, config);
  if (local_map.points.empty()) return field;
  Eigen::Vector2d least(local_map.points.front().x_m, local_map.points.front().y_m);
  Eigen::Vector2d most = least;
  for (const registration::SurfacePoint& point : local_map.points) {
    least = least.cwiseMin(Eigen::Vector2d(point.x_m, point.y_m));
    most = most.cwiseMax(Eigen::Vector2d(point.x_m, point.y_m));
  }
  field.reserve(least, most);
  for (const registration::SurfacePoint& point : local_map.points) field.add(point);
  field.forget_distances();
  return field;
}

SurfaceState state_near(const StateGrid& states, const Eigen::Vector2d& point_m) {
  const Cell cell = states.cell_at(point_m);
  const SurfaceState own = states.get(cell);
  if (own == SurfaceState::kUnknown) return own;
  const bool is_surface = any_beside(
      cell, [&](const Cell& other) { return states.get(other) == SurfaceState::kOccupied; });
  return is_surface ? SurfaceState::kOccupied : own;
}

Agreement agreement_of(std::size_t surface, std::size_t free, std::size_t all) {
  const std::size_t seen = surface + free;
  if (seen == 0) return {};
  return {static_cast<double>(seen) / static_cast<double>(all),
          static_cast<double>(surface) / static_cast<double>(seen)};
}

}  // namespace strata::slam
