// SPDX-License-Identifier: Apache-2.0
#include "core/localization/laser_columns.hpp"

#include <algorithm>
#include <cmath>

namespace strata::localization {

void LaserColumns::resize(std::size_t count) {
  count_ = count;
  const std::size_t vectors = (count + rays::BeamBundles::kVector - 1) / rays::BeamBundles::kVector;
  for (auto* column : {&x_m_, &y_m_, &cosine_, &sine_, &column_, &row_}) {
    column->resize(vectors * rays::BeamBundles::kVector);
  }
}

void LaserColumns::set(std::size_t n, const Pose2& laser) {
  x_m_[n] = laser.x;
  y_m_[n] = laser.y;
  cosine_[n] = std::cos(laser.theta);
  sine_[n] = std::sin(laser.theta);
}

void LaserColumns::take(const ParticleSet& particles, std::size_t begin, std::size_t end,
                        const Pose2& robot_from_laser) {
  resize(end - begin);
  for (std::size_t n = 0; n < padded(); ++n) {
    set(n, particles.pose(std::min(begin + n, end - 1)) * robot_from_laser);
  }
}

void LaserColumns::take(const Pose2& map_from_laser) {
  resize(1);
  for (std::size_t n = 0; n < padded(); ++n) set(n, map_from_laser);
}

rays::BeamBundles LaserColumns::bundles(const rays::RayTable& table, const rays::ScanBeams& beams,
                                        double max_range_m) {
  for (std::size_t n = 0; n < padded(); ++n) {
    column_[n] = table.column_at(x_m_[n]);
    row_[n] = table.row_at(y_m_[n]);
  }
  return {column_.data(),      row_.data(),       cosine_.data(), sine_.data(), padded(),
          beams.cosine.data(), beams.sine.data(), beams.size(),   max_range_m};
}

}  // namespace strata::localization
