// SPDX-License-Identifier: Apache-2.0
#include "core/localization/likelihood_field_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/config.hpp"
#include "core/localization/particle_kernels.hpp"
#include "core/localization/unjudged_beams.hpp"

namespace strata::localization {
namespace {
constexpr std::size_t kWeighedAtOnce = 256;
constexpr double kMinRange_m = 1e-9;
/// Hits that are asked whether they are inliers, at most: each costs a ray.
constexpr std::size_t kExplained = 60;
}  // namespace

LikelihoodFieldModel::LikelihoodFieldModel(const ReflectionGrid& map,
                                           const LikelihoodFieldModelConfig& config,
                                           std::shared_ptr<const rays::RayCaster> caster)
    : config_(config),
      field_(map, config.field),
      caster_(caster != nullptr ? std::move(caster)
                                : std::make_shared<const rays::RayCaster>(map)) {
  require_valid(config, "likelihood_field_model");
  const Grid<float>& inner = field_.log_likelihood();
  table_.width = inner.width() + 2;
  table_.height = inner.height() + 2;
  // 0 is the greatest log-likelihood there is.
  float least = inner.fill();
  for (const float value : inner.values()) least = std::min(least, value);
  quantum_ = std::max(1e-12, -static_cast<double>(least) / 65535.0);
  const auto steps = [&](float value) {
    return static_cast<std::uint16_t>(
        std::lround(std::clamp(-static_cast<double>(value) / quantum_, 0.0, 65535.0)));
  };
  bordered_.assign(static_cast<std::size_t>(table_.width) * static_cast<std::size_t>(table_.height),
                   steps(inner.fill()));
  for (int row = 0; row < inner.height(); ++row) {
    const auto from = inner.values().begin() + static_cast<std::ptrdiff_t>(row) * inner.width();
    std::transform(from, from + inner.width(),
                   bordered_.begin() + static_cast<std::ptrdiff_t>(row + 1) * table_.width + 1,
                   steps);
  }
  table_.values = bordered_.data();
  inlier_from_ = static_cast<float>(
      std::log(config.field.hit_weight * std::exp(-4.5) + (1.0 - config.field.hit_weight)));
}

void LikelihoodFieldModel::find_points(const Scan& scan, std::size_t most, Points& points) const {
  points.beams.clear();
  points.x.clear();
  points.y.clear();
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) == BeamKind::kHit) points.beams.push_back(static_cast<std::uint32_t>(beam));
  }
  const std::size_t hits = points.beams.size();
  const std::size_t count = most == 0 ? hits : std::min(most, hits);
  const double scale = 1.0 / field_.log_likelihood().resolution_m();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t beam = points.beams[k * hits / count];
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    const double bearing = scan.bearing_rad(beam);
    const Eigen::Vector2d point =
        scan.robot_from_laser *
        Eigen::Vector2d(range_m * std::cos(bearing), range_m * std::sin(bearing));
    points.x.push_back(static_cast<float>(point.x() * scale));
    points.y.push_back(static_cast<float>(point.y() * scale));
  }
}

std::size_t LikelihoodFieldModel::log_likelihoods(const Scan& scan, const Weighing& weighing,
                                                  ParticleSet& particles,
                                                  std::span<double> log_likelihood,
                                                  WorkerPool& pool) const {
  const auto points = points_.acquire();
  const double most = std::ceil(weighing.share * config_.max_beams);  // 0 is all of them
  find_points(scan, static_cast<std::size_t>(most), *points);
  const FieldPoints field_points{points->x.data(), points->y.data(), points->x.size()};
  const double scale = 1.0 / field_.log_likelihood().resolution_m();
  const Cell corner = field_.log_likelihood().rect().min;
  const double factor = -quantum_ / weighing.tempering;
  // The border shifts the table by one cell.
  const double offset_x = 1.0 - corner.x;
  const double offset_y = 1.0 - corner.y;
  const auto weigh = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    std::array<float, kWeighedAtOnce> x;
    std::array<float, kWeighedAtOnce> y;
    std::array<float, kWeighedAtOnce> c;
    std::array<float, kWeighedAtOnce> s;
    std::array<std::uint32_t, kWeighedAtOnce> sums;
    to_cells({particles.x_m.data() + begin, particles.y_m.data() + begin,
              particles.theta_rad.data() + begin, nullptr, end - begin},
             scale, offset_x, offset_y, {x.data(), y.data(), c.data(), s.data()});
    sum_field(table_, {x.data(), y.data(), c.data(), s.data(), end - begin}, field_points,
              sums.data());
    for (std::size_t i = begin; i < end; ++i) {
      log_likelihood[i] = static_cast<double>(sums[i - begin]) * factor;
    }
  };
  pool.for_chunks(particles.size(), kWeighedAtOnce, std::cref(weigh));
  return points->x.size();
}

InlierShares LikelihoodFieldModel::inlier_shares(const Scan& scan, const Pose2& map_from_robot,
                                                 const ParticleSet& /*particles*/) const {
  const auto points = points_.acquire();
  const auto most = static_cast<std::size_t>(config_.max_beams);
  find_points(scan, most == 0 ? kExplained : std::min(most, kExplained), *points);
  const std::size_t count = points->x.size();
  if (count == 0) return {};
  const double resolution = field_.log_likelihood().resolution_m();
  const Eigen::Vector2d laser = (map_from_robot * scan.robot_from_laser).translation();
  const double tolerance_m = 3.0 * config_.field.hit_stddev_m;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(map_from_robot.theta).toRotationMatrix();
  InlierShares said;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d in_robot(static_cast<double>(points->x[k]) * resolution,
                                   static_cast<double>(points->y[k]) * resolution);
    const Eigen::Vector2d point = map_from_robot.translation() + turn * in_robot;
    const double range_m = (point - laser).norm();
    const Eigen::Vector2d direction = (point - laser) / std::max(range_m, kMinRange_m);
    const double expected_m =
        caster_->range_m(laser.x(), laser.y(), direction.x(), direction.y(), range_m + tolerance_m);
    const bool is_near = static_cast<float>(field_.at(point)) >= inlier_from_;
    const bool is_met = std::abs(expected_m - range_m) <= tolerance_m;
    if (!is_near && !is_met && !(expected_m < range_m) &&
        !knows_end(*caster_, laser, point, tolerance_m)) {
      continue;
    }
    said.judged += 1.0;
    said.inlier += is_near ? 1.0 : 0.0;
    said.met += is_met ? 1.0 : 0.0;
    said.at_surface += is_near || is_met ? 1.0 : 0.0;
    said.stopped += !is_near && !is_met && range_m < expected_m ? 1.0 : 0.0;
  }
  said.divide_by(static_cast<double>(count));
  return said;
}

void LikelihoodFieldModel::find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                                         std::vector<std::uint8_t>& is_unjudged) const {
  const Pose2 laser = map_from_robot * scan.robot_from_laser;
  const auto expected_m = [&](std::size_t /*beam*/, const Eigen::Vector2d& direction,
                              double limit_m) {
    return caster_->range_m(laser.x, laser.y, direction.x(), direction.y(), limit_m);
  };
  mark_unjudged(*caster_, scan, laser, 3.0 * config_.field.hit_stddev_m, expected_m, is_unjudged);
}

}  // namespace strata::localization
