// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/seen_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace strata::patch_beams {
namespace {

/// The cosine of the sum of two angles in [0, pi], -1 when that is beyond pi.
double cosine_of_sum(double cosine_a, double cosine_b) {
  if (cosine_a <= -cosine_b) return -1.0;
  const double sine_a = std::sqrt(std::max(0.0, 1.0 - cosine_a * cosine_a));
  const double sine_b = std::sqrt(std::max(0.0, 1.0 - cosine_b * cosine_b));
  return cosine_a * cosine_b - sine_a * sine_b;
}

}  // namespace

void SeenBoxes::take(const PatchRayCaster& caster, const localization::LaserColumns& lasers,
                     const ChunkStates& states, double max_range_m) {
  lasers_ = lasers.padded();
  columns_.clear();
  contents_.clear();
  ways_.clear();
  if (caster.boxes().empty()) return;
  const auto [low_x, high_x] = std::minmax_element(lasers.x_m().begin(), lasers.x_m().end());
  const auto [low_y, high_y] = std::minmax_element(lasers.y_m().begin(), lasers.y_m().end());
  middle_x_m_ = 0.5 * (*low_x + *high_x);
  middle_y_m_ = 0.5 * (*low_y + *high_y);
  radius_m_ = 0.5 * std::hypot(*high_x - *low_x, *high_y - *low_y);
  heading_cosine_ = lasers.heading_cosine().front();
  heading_sine_ = lasers.heading_sine().front();
  spread_cosine_ = 1.0;
  for (std::size_t n = 0; n < lasers_; ++n) {
    spread_cosine_ = std::min(spread_cosine_, heading_cosine_ * lasers.heading_cosine()[n] +
                                                  heading_sine_ * lasers.heading_sine()[n]);
  }
  for (const rays::RayBox& box : caster.boxes()) {
    if (box.min_x_m < *high_x + max_range_m && box.max_x_m > *low_x - max_range_m &&
        box.min_y_m < *high_y + max_range_m && box.max_y_m > *low_y - max_range_m) {
      take_box(caster, box, lasers, states, max_range_m);
    }
  }
  name_boxes();
}

/// Where a box lies from each of the lasers [begin, end), and how far away, into its columns;
/// whether any of them is within max_range_m of it.
bool SeenBoxes::place_box(const rays::RayBox& seen, const localization::LaserColumns& lasers,
                          std::size_t begin, std::size_t end, double max_range_m,
                          double* column) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const double* const x_m = lasers.x_m().data();
  const double* const y_m = lasers.y_m().data();
  double* const near_m = column + 4 * lasers_;
  const double max_squared = max_range_m * max_range_m;
  double nearest_m = kFar;
  for (std::size_t n = begin; n < end; ++n) {
    const double min_x = seen.min_x_m - x_m[n];
    const double min_y = seen.min_y_m - y_m[n];
    const double max_x = seen.max_x_m - x_m[n];
    const double max_y = seen.max_y_m - y_m[n];
    const double dx = std::max(std::max(min_x, -max_x), 0.0);
    const double dy = std::max(std::max(min_y, -max_y), 0.0);
    const double away_m = dx * dx + dy * dy < max_squared ? std::max(dx, dy) : kFar;
    column[n] = min_x;
    column[lasers_ + n] = min_y;
    column[2 * lasers_ + n] = max_x;
    column[3 * lasers_ + n] = max_y;
    near_m[n] = away_m;
    nearest_m = std::min(nearest_m, away_m);
  }
  return nearest_m < kFar;
}

void SeenBoxes::take_box(const PatchRayCaster& caster, const rays::RayBox& box,
                         const localization::LaserColumns& lasers, const ChunkStates& states,
                         double max_range_m) {
  const std::size_t place = ways_.size();
  columns_.resize((place + 1) * kColumns * lasers_);
  contents_.resize((place + 1) * lasers_);
  double* const column = columns_.data() + place * kColumns * lasers_;
  double* const near_m = column + 4 * lasers_;
  double* const hidden = column + 5 * lasers_;
  std::fill(near_m, near_m + lasers_, std::numeric_limits<double>::infinity());
  bool any = false;
  bool all_uniform = true;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < lasers.count(); begin = end) {
    const int current = states.submap[begin];
    const int fixed = states.fixed(begin);
    end = begin + 1;
    while (end < lasers.count() && states.submap[end] == current && states.fixed(end) == fixed) {
      ++end;
    }
    const std::span<const CellOwner> owners = caster.owners_in(box, current);
    CellOwner cells = owners.size() == 1 ? owners.front() : CellOwner{};
    cells.mask &= PatchRayCaster::counting(cells.submap, current, fixed);
    std::fill(contents_.begin() + static_cast<std::ptrdiff_t>(place * lasers_ + begin),
              contents_.begin() + static_cast<std::ptrdiff_t>(place * lasers_ + end), cells);
    if (!caster.may_end_beams(box, current, fixed)) continue;
    const rays::RayBox& seen = caster.seen(box, current);
    if (!place_box(seen, lasers, begin, end, max_range_m, column)) continue;
    std::fill(hidden + begin, hidden + end, static_cast<double>(caster.hidden_in(box, current)));
    any = true;
    all_uniform = all_uniform && caster.is_uniform(box, current);
  }
  if (!any) {
    columns_.resize(place * kColumns * lasers_);
    contents_.resize(place * lasers_);
    return;
  }
  // All of the box, and of the lasers, in circles.
  const double x = 0.5 * (box.min_x_m + box.max_x_m) - middle_x_m_;
  const double y = 0.5 * (box.min_y_m + box.max_y_m) - middle_y_m_;
  const double away_m = std::hypot(x, y);
  const double radius_m =
      radius_m_ + 0.5 * std::hypot(box.max_x_m - box.min_x_m, box.max_y_m - box.min_y_m);
  Way& way = ways_.emplace_back();
  way.is_uniform = all_uniform;
  if (away_m <= radius_m) return;
  const double sine = radius_m / away_m;
  constexpr double kRounding = 1e-9;
  way.x = x / away_m;
  way.y = y / away_m;
  way.min_cosine =
      cosine_of_sum(spread_cosine_, std::sqrt(std::max(0.0, 1.0 - sine * sine))) - kRounding;
}

void SeenBoxes::name_boxes() {
  boxes_.clear();
  for (std::size_t box = 0; box < ways_.size(); ++box) {
    const double* const column = columns_.data() + box * kColumns * lasers_;
    boxes_.push_back(
        {column, column + lasers_, column + 2 * lasers_, column + 3 * lasers_, column + 4 * lasers_,
         column + 5 * lasers_,
         box < rays::BoxCrossings::kNamed ? std::ldexp(1.0, static_cast<int>(box)) : 0.0,
         static_cast<std::uint32_t>(box), ways_[box].is_uniform});
  }
}

std::span<const rays::BoxColumns> SeenBoxes::near_beam(double cosine, double sine) {
  near_.clear();
  const double c = heading_cosine_ * cosine - heading_sine_ * sine;
  const double s = heading_sine_ * cosine + heading_cosine_ * sine;
  for (std::size_t box = 0; box < ways_.size(); ++box) {
    if (c * ways_[box].x + s * ways_[box].y < ways_[box].min_cosine) continue;
    near_.push_back(boxes_[box]);
  }
  return near_;
}

}  // namespace strata::patch_beams
