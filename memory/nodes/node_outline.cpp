// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/node_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strata::memory {
namespace {

/// Two corners belong to one surface unless a beam from the node would graze it at less than this.
constexpr double kMinIncidence_rad = 4.0 * std::numbers::pi / 180.0;
constexpr std::size_t kLongestGap = 3;
constexpr std::size_t kBlock = 8;

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
  std::vector<bool> free_end(count);
  const double step = bins.angle_bin_rad();
  for (std::size_t a = 0; a < count; ++a) {
    known[a] = !std::isnan(range_m[a]);
    open[a] = std::isinf(range_m[a]);
    free_end[a] = range_m[a] < 0.0F;
    const double radius = !known[a] ? own_place_m
                          : open[a] ? bins.max_range_m
                                    : std::abs(static_cast<double>(range_m[a]));
    radius_m_.push_back(static_cast<float>(radius));
  }
  bridge_gaps(known, free_end);
  for (std::size_t a = 0; a < count; ++a) {
    const double angle = (static_cast<double>(a) + 0.5) * step;
    x_m_.push_back(radius_m_[a] * static_cast<float>(std::cos(angle)));
    y_m_.push_back(radius_m_[a] * static_cast<float>(std::sin(angle)));
  }
  classify_edges(known, open, free_end);
  inner_m_ = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < count; ++a) {
    const Eigen::Vector2d p = corner_m(a);
    const Eigen::Vector2d along = corner_m(next(a)) - p;
    const double squared = along.squaredNorm();
    const double t = squared > 0.0 ? std::clamp(-p.dot(along) / squared, 0.0, 1.0) : 0.0;
    inner_m_ = std::min(inner_m_, (p + t * along).norm());
  }
  inner_m_ *= 1.0 - 1e-6;  // stay inside in spite of rounding
  measure_blocks();
}

void NodeOutline::measure_blocks() {
  // The neighbours of a group must lie within half a turn: with few bins none are passed together.
  const float together = size() >= 2 * kBlock ? 1.0F - 1e-6F : 0.0F;  // as above
  for (std::size_t begin = 0; begin < size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, size());
    const float smallest = *std::min_element(radius_m_.begin() + static_cast<std::ptrdiff_t>(begin),
                                             radius_m_.begin() + static_cast<std::ptrdiff_t>(end)) *
                           together;
    block_.push_back({smallest / radius_m_[begin], smallest / radius_m_[end - 1]});
  }
}

void NodeOutline::bridge_gaps(std::vector<bool>& known, std::vector<bool>& free_end) {
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
    if (std::abs(from - to) > std::min(from, to) * span / std::tan(kMinIncidence_rad)) continue;
    for (std::size_t k = 1; k <= gap; ++k) {
      // Where the bin's centre meets the straight line between the two corners.
      const double angle = step * static_cast<double>(k);
      const double radius =
          from * to * std::sin(span) / (from * std::sin(angle) + to * std::sin(span - angle));
      radius_m_[(a + k) % count] = static_cast<float>(radius);
      known[(a + k) % count] = true;
      free_end[(a + k) % count] = free_end[a] || free_end[end];
    }
  }
}

void NodeOutline::classify_edges(const std::vector<bool>& known, const std::vector<bool>& open,
                                 const std::vector<bool>& free_end) {
  const double slope = 1.0 / (bins_per_rad_ * std::tan(kMinIncidence_rad));
  for (std::size_t a = 0; a < size(); ++a) {
    const std::size_t b = next(a);
    const auto from = static_cast<double>(radius_m_[a]);
    const auto to = static_cast<double>(radius_m_[b]);
    if (!known[a] || !known[b]) {
      edge_.push_back(Edge::kUnseen);
    } else if (open[a] && open[b]) {
      edge_.push_back(Edge::kOpen);
    } else if (free_end[a] || free_end[b]) {
      edge_.push_back(Edge::kHidden);
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

bool NodeOutline::is_within(const Eigen::Vector2d& point_m, std::size_t sector) const {
  const Eigen::Vector2d p = corner_m(sector);
  const Eigen::Vector2d along = corner_m(next(sector)) - p;
  return cross(along.x(), along.y(), point_m.x() - p.x(), point_m.y() - p.y()) >= 0.0;
}

bool NodeOutline::contains(const Eigen::Vector2d& point_m) const {
  return view_from(point_m).inside;
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
  if (from_m.squaredNorm() < inner_m_ * inner_m_) return {from_m, true, true, 0};
  const std::size_t sector = sector_of(from_m.x(), from_m.y());
  return {from_m, is_within(from_m, sector), false, sector};
}

template <bool kTurnsLeft>
std::size_t NodeOutline::follow(std::size_t sector, double moment,
                                const Eigen::Vector2d& direction) const {
  // The beam's line meets the ray through a corner at moment / cross(corner, direction) of the
  // corner's distance: before the corner while that is within (0, 1).
  const auto is_passed = [&](std::size_t corner, double scale) {
    const double turn =
        scale * cross(static_cast<double>(x_m_[corner]), static_cast<double>(y_m_[corner]),
                      direction.x(), direction.y());
    return kTurnsLeft ? turn > moment : turn < moment;
  };
  std::size_t left = size();
  while (left > 0) {
    const std::size_t corner = kTurnsLeft ? next(sector) : sector;
    const std::size_t begin = corner - corner % kBlock;
    const std::size_t end = std::min(begin + kBlock, size());
    if (corner == (kTurnsLeft ? begin : end - 1)) {
      // Between two bearings, less than half a turn apart, a line is nowhere further from the node
      // than at one of them.
      const Block& block = block_[begin / kBlock];
      if (is_passed(begin, static_cast<double>(block.first_scale)) &&
          is_passed(end - 1, static_cast<double>(block.last_scale))) {
        sector = kTurnsLeft ? end - 1 : previous(begin);
        left -= std::min(left, end - begin);
        continue;
      }
    }
    if (!is_passed(corner, 1.0)) break;
    sector = kTurnsLeft ? corner : previous(sector);
    --left;
  }
  return sector;
}

std::size_t NodeOutline::begin(const Viewpoint& view, const Eigen::Vector2d& direction) const {
  if (!view.within_inner) return view.sector;
  // Nothing is met before the beam leaves the circle that touches the nearest edge.
  const Eigen::Vector2d& from_m = view.from_m;
  const double along = from_m.dot(direction);
  const double t = std::sqrt(along * along + inner_m_ * inner_m_ - from_m.squaredNorm()) - along;
  return sector_of(from_m.x() + t * direction.x(), from_m.y() + t * direction.y());
}

NodeOutline::Reach NodeOutline::cast(const Viewpoint& view,
                                     const Eigen::Vector2d& direction) const {
  if (!view.inside) return {};
  // The bearing of the beam's point, seen from the node, turns one way only.
  const double moment = cross(view.from_m.x(), view.from_m.y(), direction.x(), direction.y());
  const std::size_t first = begin(view, direction);
  const std::size_t sector = moment > 0.0 ? follow<true>(first, moment, direction)
                                          : follow<false>(first, moment, direction);
  return meet(sector, view.from_m, direction);
}

void NodeOutline::cast(const Viewpoint& view, std::span<const Eigen::Vector2d> directions,
                       std::span<Reach> reach) const {
  if (!view.inside) {
    std::fill(reach.begin(), reach.end(), Reach());
    return;
  }
  if (directions.size() == 1) {
    reach[0] = cast(view, directions[0]);
    return;
  }
  // Beams that turn left are told one after the other to the left, and those that turn right to
  // the right.
  const bool is_clockwise =
      !directions.empty() &&
      cross(directions[0].x(), directions[0].y(), directions[1].x(), directions[1].y()) < 0.0;
  sweep<true>(view, directions, is_clockwise, reach);
  sweep<false>(view, directions, !is_clockwise, reach);
}

template <bool kTurnsLeft>
void NodeOutline::sweep(const Viewpoint& view, std::span<const Eigen::Vector2d> directions,
                        bool backwards, std::span<Reach> reach) const {
  const Eigen::Vector2d* before = nullptr;
  std::size_t sector = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const std::size_t beam = backwards ? directions.size() - 1 - i : i;
    const Eigen::Vector2d& direction = directions[beam];
    const double moment = cross(view.from_m.x(), view.from_m.y(), direction.x(), direction.y());
    if ((moment > 0.0) != kTurnsLeft) continue;
    // Turned on towards the node, a beam comes nearer to it at every bearing than the one before:
    // it passes the same corners.
    const double turn =
        before == nullptr ? 0.0 : cross(before->x(), before->y(), direction.x(), direction.y());
    const bool goes_on = before != nullptr && (kTurnsLeft ? turn >= 0.0 : turn <= 0.0);
    if (!goes_on) sector = begin(view, direction);
    sector = follow<kTurnsLeft>(sector, moment, direction);
    reach[beam] = meet(sector, view.from_m, direction);
    before = &direction;
  }
}

std::size_t NodeOutline::bytes() const {
  return size() * (3 * sizeof(float) + sizeof(Edge)) + block_.size() * sizeof(Block);
}

}  // namespace strata::memory
