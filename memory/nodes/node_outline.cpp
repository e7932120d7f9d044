// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/node_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strata::memory {
namespace {

/// Two corners belong to one surface unless a beam from the node would graze it at less than this.
constexpr double kLeastIncidence_rad = 4.0 * std::numbers::pi / 180.0;
constexpr std::size_t kLongestGap = 3;

/// atan2 to within 1e-4 rad, several times faster [abramowitz1964handbook, 4.4.49].
double quick_atan2(double y, double x) {
  const double ax = std::abs(x);
  const double ay = std::abs(y);
  const double larger = std::max(ax, ay);
  if (larger == 0.0) return 0.0;
  const double q = std::min(ax, ay) / larger;
  const double s = q * q;
  double angle =
      q * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))));
  if (ay > ax) angle = 0.5 * std::numbers::pi - angle;
  if (x < 0.0) angle = std::numbers::pi - angle;
  return y < 0.0 ? -angle : angle;
}

double cross(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

}  // namespace

NodeOutline::NodeOutline(const PolarBins& bins, double own_place_m, std::span<const float> range_m)
    : bins_per_rad_(1.0 / bins.angle_bin_rad()) {
  const std::size_t count = range_m.size();
  std::vector<bool> known(count);
  std::vector<bool> open(count);
  const double step = bins.angle_bin_rad();
  for (std::size_t a = 0; a < count; ++a) {
    known[a] = !std::isnan(range_m[a]);
    open[a] = std::isinf(range_m[a]);
    const double radius = !known[a] ? own_place_m
                          : open[a] ? bins.max_range_m
                                    : static_cast<double>(range_m[a]);
    radius_m_.push_back(static_cast<float>(radius));
  }
  bridge_gaps(known);
  for (std::size_t a = 0; a < count; ++a) {
    const double angle = (static_cast<double>(a) + 0.5) * step;
    x_m_.push_back(radius_m_[a] * static_cast<float>(std::cos(angle)));
    y_m_.push_back(radius_m_[a] * static_cast<float>(std::sin(angle)));
  }
  classify_edges(known, open);
  inner_m_ = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < count; ++a) {
    const Eigen::Vector2d p = corner_m(a);
    const Eigen::Vector2d along = corner_m(next(a)) - p;
    const double squared = along.squaredNorm();
    const double t = squared > 0.0 ? std::clamp(-p.dot(along) / squared, 0.0, 1.0) : 0.0;
    inner_m_ = std::min(inner_m_, (p + t * along).norm());
  }
  inner_m_ *= 1.0 - 1e-6;  // stay inside in spite of rounding
}

void NodeOutline::bridge_gaps(std::vector<bool>& known) {
  const std::size_t count = size();
  const double step = 1.0 / bins_per_rad_;
  const std::vector<bool> measured = known;
  for (std::size_t a = 0; a < count; ++a) {
    if (!measured[a] || measured[next(a)]) continue;
    std::size_t gap = 1;
    while (gap <= kLongestGap && !measured[(a + 1 + gap) % count]) ++gap;
    if (gap > kLongestGap) continue;
    const std::size_t end = (a + 1 + gap) % count;
    const auto from = static_cast<double>(radius_m_[a]);
    const auto to = static_cast<double>(radius_m_[end]);
    const double span = step * static_cast<double>(gap + 1);
    if (std::abs(from - to) > std::min(from, to) * span / std::tan(kLeastIncidence_rad)) continue;
    for (std::size_t k = 1; k <= gap; ++k) {
      // Where the bin's centre meets the straight line between the two corners.
      const double angle = step * static_cast<double>(k);
      const double radius =
          from * to * std::sin(span) / (from * std::sin(angle) + to * std::sin(span - angle));
      radius_m_[(a + k) % count] = static_cast<float>(radius);
      known[(a + k) % count] = true;
    }
  }
}

void NodeOutline::classify_edges(const std::vector<bool>& known, const std::vector<bool>& open) {
  const double slope = 1.0 / (bins_per_rad_ * std::tan(kLeastIncidence_rad));
  for (std::size_t a = 0; a < size(); ++a) {
    const std::size_t b = next(a);
    const auto from = static_cast<double>(radius_m_[a]);
    const auto to = static_cast<double>(radius_m_[b]);
    if (!known[a] || !known[b]) {
      edge_.push_back(Edge::kUnseen);
    } else if (open[a] && open[b]) {
      edge_.push_back(Edge::kOpen);
    } else {
      const bool one_surface = std::abs(from - to) <= slope * std::min(from, to);
      edge_.push_back(one_surface ? Edge::kSurface : Edge::kHidden);
    }
  }
}

std::size_t NodeOutline::sector_of(double x, double y) const {
  const auto count = static_cast<double>(size());
  double place = quick_atan2(y, x) * bins_per_rad_ - 0.5;
  if (place < 0.0) place += count;
  const auto sector = static_cast<std::size_t>(place);
  return sector < size() ? sector : 0;
}

bool NodeOutline::contains(const Eigen::Vector2d& point_m) const {
  if (point_m.squaredNorm() < inner_m_ * inner_m_) return true;
  const std::size_t a = sector_of(point_m.x(), point_m.y());
  const Eigen::Vector2d p = corner_m(a);
  const Eigen::Vector2d along = corner_m(next(a)) - p;
  return cross(along.x(), along.y(), point_m.x() - p.x(), point_m.y() - p.y()) >= 0.0;
}

NodeOutline::Reach NodeOutline::meet(std::size_t sector, const Eigen::Vector2d& from_m,
                                     const Eigen::Vector2d& direction) const {
  if (edge_[sector] == Edge::kUnseen) return {};
  const Eigen::Vector2d p = corner_m(sector);
  const Eigen::Vector2d along = corner_m(next(sector)) - p;
  const double denominator = cross(direction.x(), direction.y(), along.x(), along.y());
  const double range_m =
      cross(p.x() - from_m.x(), p.y() - from_m.y(), along.x(), along.y()) / denominator;
  if (!std::isfinite(range_m)) return {};
  return {std::max(0.0, range_m), edge_[sector]};
}

NodeOutline::Viewpoint NodeOutline::view_from(const Eigen::Vector2d& from_m) const {
  Viewpoint view{from_m, false, from_m.squaredNorm() < inner_m_ * inner_m_, 0};
  view.inside = view.within_inner || contains(from_m);
  if (!view.within_inner) view.sector = sector_of(from_m.x(), from_m.y());
  return view;
}

NodeOutline::Reach NodeOutline::cast(const Viewpoint& view,
                                     const Eigen::Vector2d& direction) const {
  if (!view.inside) return {};
  const Eigen::Vector2d& from_m = view.from_m;
  std::size_t sector = view.sector;
  if (view.within_inner) {
    // Nothing is met before the beam leaves the circle that touches the nearest edge.
    const double along = from_m.dot(direction);
    const double t = std::sqrt(along * along + inner_m_ * inner_m_ - from_m.squaredNorm()) - along;
    sector = sector_of(from_m.x() + t * direction.x(), from_m.y() + t * direction.y());
  }
  // The bearing of the beam's point, seen from the node, turns one way only. The beam's line meets
  // the ray through a corner at moment / cross(corner, direction) of the corner's distance: before
  // the corner while that is within (0, 1), and then the beam goes on into the sector beyond.
  const double moment = cross(from_m.x(), from_m.y(), direction.x(), direction.y());
  const auto turn_at = [&](std::size_t corner) {
    return cross(static_cast<double>(x_m_[corner]), static_cast<double>(y_m_[corner]),
                 direction.x(), direction.y());
  };
  if (moment > 0.0) {
    for (std::size_t step = 0; step < size(); ++step) {
      const std::size_t corner = next(sector);
      if (!(turn_at(corner) > moment)) break;
      sector = corner;
    }
  } else {
    for (std::size_t step = 0; step < size(); ++step) {
      if (!(turn_at(sector) < moment)) break;
      sector = sector == 0 ? size() - 1 : sector - 1;
    }
  }
  return meet(sector, from_m, direction);
}

std::size_t NodeOutline::bytes() const { return size() * (3 * sizeof(float) + sizeof(Edge)); }

}  // namespace strata::memory
