// SPDX-License-Identifier: Apache-2.0
#include "components/convert/map_messages.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

// So far out, and no farther, the sides of a rectangle are ints too.
constexpr int kFarthestCell = (1 << 30) - 1;
constexpr float kMaxProbability = 1.0F + 1e-5F;  // sums of shares may round up

/// Cells from a hair to a house.
void require_resolution(double resolution_m, const char* place) {
  if (resolution_m >= 1e-5 && resolution_m <= 1e2) return;
  throw InputError(place, "its resolution is not one", "publish metres a cell, such as 0.05");
}

/// Throws InputError for a coordinate that only a damaged message has.
int require_cell(double coordinate) {
  if (!(std::abs(coordinate) <= kFarthestCell)) {
    throw InputError("grid message", "a cell lies more than 2^30 cells from the origin",
                     "check the sender's version");
  }
  return static_cast<int>(coordinate);
}

void require_size(std::size_t values, const CellRect& rect, double resolution_m) {
  if (rect.area() != values || !(resolution_m > 0.0)) {
    throw InputError("grid message", "its values do not fill its rectangle",
                     "check the sender's version");
  }
  require_resolution(resolution_m, "grid message");
}

/// each: whether a value is sound.
template <typename T, typename Each>
void require_each(const std::vector<T>& values, const char* what, const Each& each) {
  if (std::all_of(values.begin(), values.end(), each)) return;
  throw InputError("grid message", std::string("a value is no ") + what,
                   "check the sender's version");
}

}  // namespace

nav_msgs::msg::OccupancyGrid to_occupancy(const ReflectionGrid& grid, Stamp stamp,
                                          const std::string& frame) {
  nav_msgs::msg::OccupancyGrid message;
  message.header(make_header(stamp, frame));
  message.info().map_load_time(to_message(stamp));
  message.info().resolution(static_cast<float>(grid.resolution_m()));
  message.info().width(static_cast<std::uint32_t>(grid.width()));
  message.info().height(static_cast<std::uint32_t>(grid.height()));
  const double resolution_m = grid.resolution_m();
  message.info().origin(
      to_pose({grid.rect().min.x * resolution_m, grid.rect().min.y * resolution_m, 0.0}));
  std::vector<std::int8_t>& data = message.data();
  data.reserve(grid.size());
  for (const float value : grid.values()) {
    const float percent = std::round(100.0F * std::clamp(value, 0.0F, 1.0F));
    data.push_back(is_known(value) ? static_cast<std::int8_t>(percent) : std::int8_t{-1});
  }
  return message;
}

ReflectionGrid from_message(const nav_msgs::msg::OccupancyGrid& message) {
  // A float on the wire: 0.05 arrives as 0.0500000007, which drifts over a large map.
  const double resolution_m =
      std::round(static_cast<double>(message.info().resolution()) * 1e7) / 1e7;
  if (!(resolution_m > 0.0)) {
    throw InputError("OccupancyGrid", "its resolution is not positive", "check the map server");
  }
  require_resolution(resolution_m, "OccupancyGrid");
  const Pose2 origin = planar(from_message(message.info().origin()));
  if (!(std::abs(origin.theta) <= 1e-6)) {  // nor NaN
    throw InputError("OccupancyGrid", "its origin is turned", "publish it with yaw 0");
  }
  CellRect rect;
  rect.min = {require_cell(std::round(origin.x / resolution_m)),
              require_cell(std::round(origin.y / resolution_m))};
  rect.max = {require_cell(static_cast<double>(rect.min.x) + message.info().width()),
              require_cell(static_cast<double>(rect.min.y) + message.info().height())};
  require_size(message.data().size(), rect, resolution_m);
  ReflectionGrid grid = make_reflection_grid(resolution_m, rect);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::int8_t percent = message.data()[i];
    if (percent >= 0) grid.values()[i] = std::min(1.0F, static_cast<float>(percent) / 100.0F);
  }
  return grid;
}

strata_msgs::msg::CellRect to_message(const CellRect& rect) {
  strata_msgs::msg::CellRect message;
  message.min_x(rect.min.x);
  message.min_y(rect.min.y);
  message.max_x(rect.max.x);
  message.max_y(rect.max.y);
  return message;
}

CellRect from_message(const strata_msgs::msg::CellRect& rect) {
  return {{require_cell(rect.min_x()), require_cell(rect.min_y())},
          {require_cell(rect.max_x()), require_cell(rect.max_y())}};
}

strata_msgs::msg::ReflectionGrid to_message(const ReflectionGrid& grid) {
  strata_msgs::msg::ReflectionGrid message;
  message.resolution(grid.resolution_m());
  message.rect(to_message(grid.rect()));
  message.reflection(grid.values());
  return message;
}

ReflectionGrid from_message(const strata_msgs::msg::ReflectionGrid& message) {
  const CellRect rect = from_message(message.rect());
  require_size(message.reflection().size(), rect, message.resolution());
  require_each(message.reflection(), "probability", [](float value) {
    return !is_known(value) || (value >= 0.0F && value <= kMaxProbability);
  });
  ReflectionGrid grid = make_reflection_grid(message.resolution(), rect);
  grid.values() = message.reflection();
  return grid;
}

strata_msgs::msg::CountGrid to_message(const Grid<CellCounts>& grid) {
  strata_msgs::msg::CountGrid message;
  message.resolution(grid.resolution_m());
  message.rect(to_message(grid.rect()));
  message.hits().reserve(grid.size());
  message.misses().reserve(grid.size());
  for (const CellCounts& cell : grid.values()) {
    message.hits().push_back(cell.hits);
    message.misses().push_back(cell.misses);
  }
  return message;
}

Grid<CellCounts> from_message(const strata_msgs::msg::CountGrid& message) {
  const CellRect rect = from_message(message.rect());
  require_size(message.hits().size(), rect, message.resolution());
  require_size(message.misses().size(), rect, message.resolution());
  for (const auto* counts : {&message.hits(), &message.misses()}) {
    require_each(*counts, "count",
                 [](double value) { return std::isfinite(value) && value >= 0.0; });
  }
  Grid<CellCounts> grid(message.resolution(), rect);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.values()[i] = {message.hits()[i], message.misses()[i]};
  }
  return grid;
}

}  // namespace strata::convert
