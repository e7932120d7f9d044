// SPDX-License-Identifier: Apache-2.0
#include "memory/levels/virtual_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/scan/range_limit.hpp"

namespace strata::memory {
namespace {

constexpr float kUnknownRange = std::numeric_limits<float>::quiet_NaN();
constexpr float kOverflowRange = std::numeric_limits<float>::infinity();

/// How far a beam reaches, and whether it hit something; 0 when it says nothing.
struct Reach {
  double range_m = 0.0;
  bool is_hit = false;
};

Reach reach_of(const PosedScan& scan, std::size_t beam, const VisibilityConfig& config,
               double far_m) {
  const BeamKind kind = scan.scan.kind(beam);
  if (!scan.static_probability.empty() &&
      static_cast<double>(scan.static_probability[beam]) < config.min_static_probability) {
    return {};
  }
  if (kind == BeamKind::kHit) return {static_cast<double>(scan.scan.ranges_m[beam]), true};
  if (kind == BeamKind::kNoReturn && config.trust_no_return) {
    const float range_max = scan.scan.range_max_m;
    return {tells_reach(range_max) ? static_cast<double>(range_max) : far_m, false};
  }
  return {};
}

constexpr std::size_t kFreeEndsInARow = 3;
constexpr double kDropShare = 0.05;
constexpr double kOneSurface = 0.1;

}  // namespace

bool drops_returns(const Scan& scan) {
  std::size_t judged = 0;
  std::size_t dropped = 0;
  for (std::size_t i = 1; i + 1 < scan.size(); ++i) {
    if (scan.kind(i - 1) != BeamKind::kHit || scan.kind(i + 1) != BeamKind::kHit) continue;
    const auto before_m = static_cast<double>(scan.ranges_m[i - 1]);
    const auto after_m = static_cast<double>(scan.ranges_m[i + 1]);
    if (std::abs(before_m - after_m) > kOneSurface * std::min(before_m, after_m)) continue;
    const BeamKind kind = scan.kind(i);
    if (kind == BeamKind::kNoReturn) ++dropped;
    if (kind == BeamKind::kNoReturn || kind == BeamKind::kHit) ++judged;
  }
  return static_cast<double>(dropped) > kDropShare * static_cast<double>(judged);
}

VirtualScanner::VirtualScanner(const PolarBins& bins, const VisibilityConfig& config)
    : bins_(bins),
      config_(config),
      boundary_m_(static_cast<std::size_t>(bins.angle_bins)),
      boundary_(static_cast<std::size_t>(bins.angle_bins)) {
  for (int a = 0; a < bins.angle_bins; ++a) {
    cos_.push_back(std::cos(bins.center_bearing_rad(a)));
    sin_.push_back(std::sin(bins.center_bearing_rad(a)));
  }
}

void VirtualScanner::add_unknown_sector(const Eigen::Vector2d& laser_m, double from_rad,
                                        double to_rad) {
  const double step_rad = std::numbers::pi / 18.0;
  const int steps = std::max(1, static_cast<int>(std::ceil((to_rad - from_rad) / step_rad)));
  for (int i = 0; i <= steps; ++i) {
    const double angle = from_rad + (to_rad - from_rad) * i / steps;
    polygon_.push_back({laser_m.x() + config_.own_place_m * std::cos(angle),
                        laser_m.y() + config_.own_place_m * std::sin(angle), false, false, true,
                        false});
  }
}

void VirtualScanner::build_polygon(const PosedScan& posed, const Eigen::Vector2d& node_m) {
  const Scan& scan = posed.scan;
  const Pose2 map_from_laser = posed.map_from_laser();
  const Eigen::Vector2d laser_m = map_from_laser.translation() - node_m;
  const double far_m = 2.0 * (bins_.max_range_m + laser_m.norm());
  const bool clockwise = scan.angle_increment_rad < 0.0F;
  const bool trusts_ends = bins_.tells_beyond() && !drops_returns(scan);
  polygon_.clear();
  bool any = false;
  double first_rad = 0.0;
  double last_rad = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const std::size_t beam = clockwise ? scan.size() - 1 - i : i;
    const Reach reach = reach_of(posed, beam, config_, far_m);
    if (reach.range_m <= 0.0) continue;
    const double angle = map_from_laser.theta + scan.bearing_rad(beam);
    if (!any) first_rad = angle;
    if (any && angle - last_rad > config_.max_gap_rad) {
      add_unknown_sector(laser_m, last_rad, angle);
    }
    polygon_.push_back({laser_m.x() + reach.range_m * std::cos(angle),
                        laser_m.y() + reach.range_m * std::sin(angle), reach.is_hit, false, false,
                        trusts_ends && !reach.is_hit});
    last_rad = angle;
    any = true;
  }
  if (!any) return;
  const double closing_rad = first_rad + 2.0 * std::numbers::pi;
  if (closing_rad - last_rad > config_.max_gap_rad) {
    add_unknown_sector(laser_m, last_rad, closing_rad);
  }
  if (config_.fill_between_beams) join_surfaces(laser_m);
  doubt_lone_free_ends();
}

void VirtualScanner::doubt_lone_free_ends() {
  for (std::size_t begin = 0; begin < polygon_.size();) {
    std::size_t end = begin;
    while (end < polygon_.size() && polygon_[end].is_free_end) ++end;
    if (end - begin < kFreeEndsInARow) {
      for (std::size_t i = begin; i < end; ++i) polygon_[i].is_free_end = false;
    }
    begin = end + 1;
  }
}

void VirtualScanner::join_surfaces(const Eigen::Vector2d& laser_m) {
  const double min_sine = std::sin(config_.min_incidence_rad);
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    Vertex& p = polygon_[i];
    const Vertex& q = polygon_[i + 1 == polygon_.size() ? 0 : i + 1];
    if (!p.is_hit || !q.is_hit) continue;
    const Eigen::Vector2d edge(q.x_m - p.x_m, q.y_m - p.y_m);
    // The further of the two beams meets the edge at the sharper angle.
    const Eigen::Vector2d to_p = Eigen::Vector2d(p.x_m, p.y_m) - laser_m;
    const Eigen::Vector2d to_q = Eigen::Vector2d(q.x_m, q.y_m) - laser_m;
    const Eigen::Vector2d& beam = to_p.squaredNorm() > to_q.squaredNorm() ? to_p : to_q;
    const double area = std::abs(edge.x() * beam.y() - edge.y() * beam.x());
    p.joins_next = area >= min_sine * edge.norm() * beam.norm();
  }
}

bool VirtualScanner::node_is_inside() const {
  // Crossings of the half-line from the node towards +x.
  bool inside = false;
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    const Vertex& p = polygon_[i];
    const Vertex& q = polygon_[i + 1 == polygon_.size() ? 0 : i + 1];
    if ((p.y_m > 0.0) == (q.y_m > 0.0)) continue;
    const double x = p.x_m - p.y_m * (q.x_m - p.x_m) / (q.y_m - p.y_m);
    if (x > 0.0) inside = !inside;
  }
  return inside;
}

void VirtualScanner::measure_boundary() {
  const double bins_per_rad = 1.0 / bins_.angle_bin_rad();
  const int count = bins_.angle_bins;
  angle_.clear();
  for (const Vertex& vertex : polygon_) {
    double angle = std::atan2(vertex.y_m, vertex.x_m) * bins_per_rad;
    if (angle < 0.0) angle += count;
    angle_.push_back(angle < count ? angle : 0.0);
  }
  std::fill(boundary_m_.begin(), boundary_m_.end(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    const std::size_t j = i + 1 == polygon_.size() ? 0 : i + 1;
    const Vertex& p = polygon_[i];
    const double edge_x = polygon_[j].x_m - p.x_m;
    const double edge_y = polygon_[j].y_m - p.y_m;
    double turn = angle_[j] - angle_[i];
    if (turn > 0.5 * count) turn -= count;
    if (turn < -0.5 * count) turn += count;
    const double low = std::min(angle_[i], angle_[i] + turn) - 0.5;
    const double high = std::max(angle_[i], angle_[i] + turn) - 0.5;
    for (int c = static_cast<int>(std::ceil(low)); c <= high; ++c) {
      const auto bin = static_cast<std::size_t>((c + count) % count);
      const double denominator = cos_[bin] * edge_y - sin_[bin] * edge_x;
      if (denominator == 0.0) continue;
      const double t = (p.x_m * edge_y - p.y_m * edge_x) / denominator;
      if (t > 0.0 && t < boundary_m_[bin]) {
        boundary_m_[bin] = t;
        boundary_[bin] = p.joins_next                                 ? Boundary::kSurface
                         : p.is_free_end && polygon_[j].is_free_end   ? Boundary::kReach
                         : p.is_own_place && polygon_[j].is_own_place ? Boundary::kUnseen
                                                                      : Boundary::kBetween;
      }
    }
  }
}

bool VirtualScanner::transform(const PosedScan& scan, const Eigen::Vector2d& node_m,
                               VirtualScan& result) {
  const auto count = static_cast<std::size_t>(bins_.angle_bins);
  result.assign(count, kUnknownRange);
  build_polygon(scan, node_m);
  if (polygon_.size() < 3 || !node_is_inside()) return false;
  measure_boundary();
  const double tolerance_m = bins_.range_bin_m();
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    if (!polygon_[i].is_hit) continue;
    const double range_m = std::hypot(polygon_[i].x_m, polygon_[i].y_m);
    const auto bin = static_cast<std::size_t>(angle_[i]);
    const double before = boundary_m_[bin == 0 ? count - 1 : bin - 1];
    const double after = boundary_m_[bin + 1 == count ? 0 : bin + 1];
    if (range_m > std::max({before, boundary_m_[bin], after}) + tolerance_m) continue;
    // A NaN does not compare as smaller, so the first point of a bin replaces it.
    if (!(result[bin] <= static_cast<float>(range_m))) result[bin] = static_cast<float>(range_m);
  }
  for (std::size_t a = 0; a < count; ++a) {
    if (std::isnan(result[a]) && std::isfinite(boundary_m_[a]) &&
        boundary_[a] == Boundary::kSurface) {
      result[a] = static_cast<float>(boundary_m_[a]);
    }
    const bool unknown = std::isnan(result[a]);
    const double reach_m = unknown ? boundary_m_[a] : static_cast<double>(result[a]);
    const bool seen = std::isfinite(reach_m) && boundary_[a] != Boundary::kUnseen;
    const bool open = reach_m >= bins_.max_range_m && (seen || !unknown);
    if (open) result[a] = kOverflowRange;
    const double free_m = boundary_m_[a] - tolerance_m;
    const bool is_free_end = std::isfinite(free_m) && boundary_[a] == Boundary::kReach;
    if (unknown && !open && is_free_end && free_m > 0.0) {
      result[a] = -static_cast<float>(free_m);
    }
  }
  return true;
}

}  // namespace strata::memory
