// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strata::topology::detail {
namespace {

/// Of the reach: how much further candidates may be. Two landmarks come nearer to each other by
/// less than that while neither has moved by half of it.
constexpr double kMargin = 0.2;
/// Of the margin: a little less than half, for what rounding does to distances.
constexpr double kMayMove = 0.49;

bool is_near(const Pose2& a, const Pose2& b, double squared_m2) {
  const double x = b.x - a.x;
  const double y = b.y - a.y;
  return x * x + y * y < squared_m2;
}

/// The landmarks that are finite, along the longer side of the building, so that few lie beside
/// each of them.
std::vector<std::pair<double, std::size_t>> in_a_row(std::span<const std::size_t> landmarks,
                                                     std::span<const Pose2> poses) {
  std::vector<std::size_t> finite;
  Eigen::Vector2d least = Eigen::Vector2d::Zero();
  Eigen::Vector2d most = least;
  for (const std::size_t landmark : landmarks) {
    const Eigen::Vector2d at = poses[landmark].translation();
    if (!at.allFinite()) continue;
    least = finite.empty() ? at : least.cwiseMin(at);
    most = finite.empty() ? at : most.cwiseMax(at);
    finite.push_back(landmark);
  }
  const bool is_wide = most.x() - least.x() > most.y() - least.y();
  std::vector<std::pair<double, std::size_t>> row;
  row.reserve(finite.size());
  for (const std::size_t landmark : finite) {
    row.emplace_back(is_wide ? poses[landmark].x : poses[landmark].y, landmark);
  }
  std::sort(row.begin(), row.end());
  return row;
}

}  // namespace

std::vector<Pair> near_pairs(std::span<const std::size_t> landmarks, std::span<const Pose2> poses,
                             double reach_m) {
  const auto row = in_a_row(landmarks, poses);
  const double squared_m2 = reach_m * reach_m;
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < row.size(); ++k) {
    for (std::size_t l = k + 1; l < row.size() && row[l].first - row[k].first < reach_m; ++l) {
      const auto [a, b] = std::minmax(row[k].second, row[l].second);
      if (is_near(poses[a], poses[b], squared_m2)) pairs.push_back({a, b});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& one, const Pair& other) {
    return std::pair(one.b, one.a) < std::pair(other.b, other.a);
  });
  return pairs;
}

NearPairs::NearPairs(std::span<const std::size_t> landmarks, double reach_m)
    : landmarks_(landmarks), reach_m_(reach_m) {}

bool NearPairs::have_moved(std::span<const Pose2> poses) const {
  if (looked_from_.size() != landmarks_.size()) return true;
  const double may_move_m = kMayMove * kMargin * reach_m_;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Eigen::Vector2d by = poses[landmarks_[i]].translation() - looked_from_[i];
    if (!(by.squaredNorm() <= may_move_m * may_move_m)) return true;
  }
  return false;
}

std::span<const Pair> NearPairs::at(std::span<const Pose2> poses) {
  if (have_moved(poses)) {
    candidates_ = near_pairs(landmarks_, poses, (1.0 + kMargin) * reach_m_);
    looked_from_.clear();
    for (const std::size_t landmark : landmarks_) {
      looked_from_.push_back(poses[landmark].translation());
    }
  }
  near_.clear();
  for (const Pair& pair : candidates_) {
    if (is_near(poses[pair.a], poses[pair.b], reach_m_ * reach_m_)) near_.push_back(pair);
  }
  return near_;
}

}  // namespace strata::topology::detail
