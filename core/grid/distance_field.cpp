// SPDX-License-Identifier: Apache-2.0
#include "core/grid/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace strata {
namespace {

constexpr std::int64_t kFar = std::numeric_limits<std::int32_t>::max();

/// Squared distance to the nearest occupied cell along a column: two sweeps.
void transform_column(const Grid<std::uint8_t>& occupied, int column,
                      std::vector<std::int64_t>& squared, std::size_t width, std::size_t height) {
  std::int64_t distance = kFar;
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t i = y * width + static_cast<std::size_t>(column);
    distance = occupied.values()[i] != 0 ? 0 : (distance == kFar ? kFar : distance + 1);
    squared[i] = distance;
  }
  distance = kFar;
  for (std::size_t y = height; y-- > 0;) {
    const std::size_t i = y * width + static_cast<std::size_t>(column);
    distance = occupied.values()[i] != 0 ? 0 : (distance == kFar ? kFar : distance + 1);
    squared[i] = std::min(squared[i], distance);
    if (squared[i] != kFar) squared[i] *= squared[i];
  }
}

/// Lower envelope of the parabolas f(q) + (x - q)^2 along a row, in whole numbers: the parabola of
/// v is below that of q for x <= separation(v, q).
class RowEnvelope {
 public:
  explicit RowEnvelope(std::size_t width) : sites_(width), starts_(width), row_(width) {}

  void transform(std::int64_t* values, std::size_t width) {
    std::copy(values, values + width, row_.begin());
    std::size_t count = 0;
    for (std::size_t q = 0; q < width; ++q) {
      if (row_[q] == kFar) continue;
      std::int64_t start = 0;
      while (count > 0) {
        start = separation(sites_[count - 1], static_cast<std::int64_t>(q)) + 1;
        if (start > starts_[count - 1]) break;
        --count;
      }
      if (count == 0) start = 0;
      if (start >= static_cast<std::int64_t>(width)) continue;
      sites_[count] = static_cast<std::int64_t>(q);
      starts_[count] = start;
      ++count;
    }
    if (count == 0) return;
    std::size_t k = 0;
    for (std::size_t x = 0; x < width; ++x) {
      while (k + 1 < count && starts_[k + 1] <= static_cast<std::int64_t>(x)) ++k;
      const std::int64_t d = static_cast<std::int64_t>(x) - sites_[k];
      values[x] = d * d + row_[static_cast<std::size_t>(sites_[k])];
    }
  }

 private:
  /// The last whole x at which the parabola of v is not above that of q > v (floor division).
  [[nodiscard]] std::int64_t separation(std::int64_t v, std::int64_t q) const {
    const std::int64_t numerator =
        q * q - v * v + row_[static_cast<std::size_t>(q)] - row_[static_cast<std::size_t>(v)];
    const std::int64_t denominator = 2 * (q - v);
    const std::int64_t quotient = numerator / denominator;
    return (numerator % denominator != 0 && numerator < 0) ? quotient - 1 : quotient;
  }
  std::vector<std::int64_t> sites_;
  std::vector<std::int64_t> starts_;
  std::vector<std::int64_t> row_;
};

}  // namespace

DistanceField make_distance_field(const Grid<std::uint8_t>& occupied, double max_distance_m) {
  const auto width = static_cast<std::size_t>(occupied.width());
  const auto height = static_cast<std::size_t>(occupied.height());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  DistanceField field(occupied.resolution_m(), occupied.rect(), kInfinity);
  std::vector<std::int64_t> squared(width * height);
  for (std::size_t x = 0; x < width; ++x) {
    transform_column(occupied, static_cast<int>(x), squared, width, height);
  }
  RowEnvelope envelope(width);
  for (std::size_t y = 0; y < height; ++y) envelope.transform(&squared[y * width], width);
  for (std::size_t i = 0; i < squared.size(); ++i) {
    double distance_m = squared[i] == kFar
                            ? std::numeric_limits<double>::infinity()
                            : occupied.resolution_m() * std::sqrt(static_cast<double>(squared[i]));
    if (max_distance_m > 0.0) distance_m = std::min(distance_m, max_distance_m);
    field.values()[i] = static_cast<float>(distance_m);
  }
  return field;
}

DistanceField make_distance_field(const ReflectionGrid& map, double max_distance_m) {
  return make_distance_field(occupied_cells(map), max_distance_m);
}

}  // namespace strata
