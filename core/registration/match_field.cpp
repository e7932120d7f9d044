// SPDX-License-Identifier: Apache-2.0
#include "core/registration/match_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/grid/growth.hpp"

namespace strata::registration {
namespace {

/// A wall is never quite free to slide along: its ends and gaps carry some information.
constexpr double kMinTangential = 0.02;
constexpr int kNeighbourhood = 2;

struct Moments {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  void add(double px, double py) {
    n += 1.0;
    x += px;
    y += py;
    xx += px * px;
    xy += px * py;
    yy += py * py;
  }
  /// n n^T blended with isotropy by how round the points' scatter is; trace 1.
  [[nodiscard]] NormalScatter normal() const {
    NormalScatter isotropic{0.5F, 0.0F, 0.5F};
    if (n < 3.0) return isotropic;
    const double cxx = xx - x * x / n;
    const double cxy = xy - x * y / n;
    const double cyy = yy - y * y / n;
    const double root = std::sqrt(0.25 * (cxx - cyy) * (cxx - cyy) + cxy * cxy);
    const double larger = 0.5 * (cxx + cyy) + root;
    if (larger <= 1e-12) return isotropic;
    const double round = std::clamp((larger - 2.0 * root) / larger, 0.0, 1.0);
    const double angle = 0.5 * std::atan2(2.0 * cxy, cxx - cyy);
    const double nx = -std::sin(angle);
    const double ny = std::cos(angle);
    const double half = 0.5 * round;
    return {static_cast<float>((1.0 - round) * nx * nx + half),
            static_cast<float>((1.0 - round) * nx * ny),
            static_cast<float>((1.0 - round) * ny * ny + half)};
  }
};

/// Beams farther apart than this look at different things.
constexpr double kFineRad = 0.035;

/// Hits within this distance of each other belong together whatever lies between.
double near_m(double beam_spacing_rad, double range_m) {
  constexpr double kMinGapM = 0.1;
  constexpr double kSpacings = 5.0;
  return std::max(kMinGapM, kSpacings * std::min(beam_spacing_rad, kFineRad) * range_m);
}

/// A hit by itself is a thing of its own where the beams beside it pass as near as this, or are
/// fine; else it may be part of any surface.
constexpr double kLoneGapM = 0.25;

/// Whether points i and i + 1 come from beams next to each other.
bool joined(const Endpoints& endpoints, std::size_t i) {
  return i + 1 < endpoints.size() && endpoints.beam[i + 1] == endpoints.beam[i] + 1;
}

/// The normal of the line through three hits of neighbouring beams, the middle one i; nothing where
/// they are on no line.
std::optional<NormalScatter> line_through(const Endpoints& endpoints, std::size_t i) {
  constexpr double kMaxSag = 0.1;  // of the shorter spacing, and in metres
  if (i == 0 || !joined(endpoints, i - 1) || !joined(endpoints, i)) return std::nullopt;
  const double ax = endpoints.x_m[i] - endpoints.x_m[i - 1];
  const double ay = endpoints.y_m[i] - endpoints.y_m[i - 1];
  const double bx = endpoints.x_m[i + 1] - endpoints.x_m[i];
  const double by = endpoints.y_m[i + 1] - endpoints.y_m[i];
  if (ax * bx + ay * by <= 0.0) return std::nullopt;
  const double length = std::hypot(ax + bx, ay + by);
  const double sag = std::abs(ax * by - ay * bx) / length;
  if (sag > kMaxSag * std::min({1.0, std::hypot(ax, ay), std::hypot(bx, by)})) return std::nullopt;
  const double nx = -(ay + by) / length;
  const double ny = (ax + bx) / length;
  return NormalScatter{static_cast<float>(nx * nx), static_cast<float>(nx * ny),
                       static_cast<float>(ny * ny)};
}

/// A wall seen at a grazing angle leaves its hits far apart, but on one line: the hit with its two
/// neighbours or, where the wall ends or somebody stands before it, with the two on one side.
std::optional<NormalScatter> grazed_wall(const Endpoints& endpoints, std::size_t point) {
  if (const auto middle = line_through(endpoints, point)) return middle;
  if (point > 0) {
    if (const auto before = line_through(endpoints, point - 1)) return before;
  }
  return line_through(endpoints, point + 1);
}

/// SweepSurface::slack_m on one side (-1 or +1) of a hit.
double gap_beside(const Endpoints& endpoints, std::size_t point, int side,
                  const NormalScatter& normal, double beam_spacing_rad) {
  constexpr double kUnseen = std::numeric_limits<double>::infinity();
  constexpr double kOnLine = 0.1;  // of the distance
  if (side < 0 ? point == 0 || !joined(endpoints, point - 1) : !joined(endpoints, point)) {
    return kUnseen;
  }
  const std::size_t next = side < 0 ? point - 1 : point + 1;
  const double x = endpoints.x_m[point];
  const double y = endpoints.y_m[point];
  const double dx = endpoints.x_m[next] - x;
  const double dy = endpoints.y_m[next] - y;
  const double range_m = std::hypot(x, y);
  const double distance_m = std::hypot(dx, dy);
  if (distance_m <= near_m(beam_spacing_rad, range_m)) return distance_m;
  const auto xx = static_cast<double>(normal.xx);
  const auto xy = static_cast<double>(normal.xy);
  const auto yy = static_cast<double>(normal.yy);
  const double off2 = xx * dx * dx + 2.0 * xy * dx * dy + yy * dy * dy;  // squared, off the line
  if (off2 <= kOnLine * kOnLine * distance_m * distance_m) return distance_m;
  if (std::hypot(endpoints.x_m[next], endpoints.y_m[next]) < range_m) return kUnseen;
  // The next beam passed beside the end of the surface: it lies before that beam.
  const double cross2 = (xx * x * x + 2.0 * xy * x * y + yy * y * y) / (range_m * range_m);
  return beam_spacing_rad * range_m / std::sqrt(std::max(cross2, 0.01));
}

}  // namespace

NormalScatter normal_of(std::span<const Eigen::Vector2d> points_m) {
  if (points_m.size() < 3) return {};
  Moments moments;
  for (const Eigen::Vector2d& point : points_m) {
    moments.add(point.x() - points_m[0].x(), point.y() - points_m[0].y());
  }
  return moments.normal();
}

void set_surface_direction(SurfacePoint& point, const NormalScatter& scatter) {
  const double xx = static_cast<double>(scatter.xx);
  const double xy = static_cast<double>(scatter.xy);
  const double yy = static_cast<double>(scatter.yy);
  const double root = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
  const double larger = 0.5 * (xx + yy) + root;
  point.tangential = 1.0;
  if (larger <= 0.0) return;
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  point.normal_x = std::cos(angle);
  point.normal_y = std::sin(angle);
  point.tangential = std::clamp((larger - 2.0 * root) / larger, kMinTangential, 1.0);
}

void surfaces_in_sweep(const Endpoints& endpoints, double beam_spacing_rad,
                       std::vector<SweepSurface>& out) {
  constexpr std::ptrdiff_t kReach = 3;
  const auto count = static_cast<std::ptrdiff_t>(endpoints.size());
  out.resize(endpoints.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double x = endpoints.x_m[at];
    const double y = endpoints.y_m[at];
    const double reach_m = near_m(beam_spacing_rad, std::hypot(x, y));
    Moments moments;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - kReach);
         j <= std::min(count - 1, i + kReach); ++j) {
      const double dx = endpoints.x_m[static_cast<std::size_t>(j)] - x;
      const double dy = endpoints.y_m[static_cast<std::size_t>(j)] - y;
      if (dx * dx + dy * dy <= reach_m * reach_m) moments.add(dx, dy);
    }
    out[at].normal = moments.normal();
    if (moments.n < 3.0) {
      if (const auto grazed = grazed_wall(endpoints, at)) {
        out[at].normal = *grazed;
      } else if (beam_spacing_rad > kFineRad && beam_spacing_rad * std::hypot(x, y) > kLoneGapM) {
        out[at].normal = {};
      }
    }
    out[at].slack_m = static_cast<float>(
        std::max(gap_beside(endpoints, at, -1, out[at].normal, beam_spacing_rad),
                 gap_beside(endpoints, at, 1, out[at].normal, beam_spacing_rad)));
  }
}

MatchField::MatchField(double resolution_m, const MatchFieldConfig& config)
    : config_(config),
      nearest_(resolution_m, CellRect{}, -1),
      squared_m2_(resolution_m, CellRect{}, std::numeric_limits<float>::infinity()) {
  require_valid(config, "match_field");
}

MatchField::MatchField(const ReflectionGrid& map, const MatchFieldConfig& config)
    : MatchField(map.resolution_m(), config) {
  const auto threshold = static_cast<float>(config.occupied_reflection);
  auto occupied = [&](const Cell& cell) { return map.get(cell) >= threshold; };
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!(map.values()[i] >= threshold)) continue;
    const Cell cell = map.cell(i);
    Moments moments;
    for (int dy = -kNeighbourhood; dy <= kNeighbourhood; ++dy) {
      for (int dx = -kNeighbourhood; dx <= kNeighbourhood; ++dx) {
        if (occupied({cell.x + dx, cell.y + dy})) moments.add(dx, dy);
      }
    }
    SurfacePoint point;
    point.x_m = map.center(cell).x();
    point.y_m = map.center(cell).y();
    set_surface_direction(point, moments.normal());
    add(point);
  }
}

void MatchField::reserve(const Eigen::Vector2d& min_m, const Eigen::Vector2d& max_m) {
  const Cell least = cell_at(min_m, resolution_m());
  const Cell most = cell_at(max_m, resolution_m());
  const CellRect rect =
      nearest_.rect().united(CellRect{least, {most.x + 1, most.y + 1}}.inflated(reach_cells()));
  hold(rect);
}

/// The labels last: where memory runs out for them, the distances cover more than they need, and
/// only they are asked where the field ends.
void MatchField::hold(const CellRect& rect) {
  squared_m2_ = squared_m2_.cropped(rect);
  nearest_ = nearest_.cropped(rect);
}

bool MatchField::is_sound() const {
  const auto count = static_cast<std::int64_t>(points_.size());
  return squared_m2_.rect().united(nearest_.rect()) == squared_m2_.rect() &&
         std::all_of(nearest_.values().begin(), nearest_.values().end(),
                     [count](std::int32_t index) { return index >= -1 && index < count; });
}

int MatchField::reach_cells() const {
  return static_cast<int>(std::ceil(config_.radius_m / resolution_m()));
}

std::size_t MatchField::add(const SurfacePoint& point) {
  const double resolution = resolution_m();
  const int reach = reach_cells();
  const Cell center{cell_coordinate(point.x_m, resolution), cell_coordinate(point.y_m, resolution)};
  const CellRect rect = CellRect{center, {center.x + 1, center.y + 1}}.inflated(reach);
  const CellRect wide = grown(nearest_.rect(), with_room(nearest_.rect(), rect));
  if (wide != nearest_.rect()) hold(wide);
  const std::size_t index = points_.size();
  points_.push_back(point);
  const auto label = static_cast<std::int32_t>(index);
  const auto limit = static_cast<float>(config_.radius_m * config_.radius_m);
  const auto step = static_cast<float>(resolution);
  const auto first_dx = static_cast<float>((rect.min.x + 0.5) * resolution - point.x_m);
  const int width = rect.width();
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    const auto dy = static_cast<float>((y + 0.5) * resolution - point.y_m);
    const float dy2 = dy * dy;
    float* best = &squared_m2_.at({rect.min.x, y});
    std::int32_t* label_of = &nearest_.at({rect.min.x, y});
    for (int i = 0; i < width; ++i) {
      const float dx = first_dx + static_cast<float>(i) * step;
      const float d2 = dx * dx + dy2;
      const bool closer = d2 < best[i] && d2 <= limit;
      best[i] = closer ? d2 : best[i];
      label_of[i] = closer ? label : label_of[i];
    }
  }
  return index;
}

}  // namespace strata::registration
