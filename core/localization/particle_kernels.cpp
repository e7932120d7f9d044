// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/particle_kernels.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/particle_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"

/// A sum in eight parts; add() takes the vector at place j < 8.
template <std::size_t kSums>
class Parts {
 public:
  HWY_INLINE void add(std::size_t sum, std::size_t j, Lanes value) {
    const Tag d;
    hn::StoreU(hn::Add(hn::LoadU(d, parts_[sum] + j), value), d, parts_[sum] + j);
  }
  HWY_INLINE double total(std::size_t sum) const {
    const double* p = parts_[sum];
    return ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]));
  }

 private:
  alignas(64) double parts_[kSums][kParts] = {};
};

/// Calls body(j, columns) for all vectors: columns are pointers to what is at the same index of
/// each array; the last ones are copied to a row that zeros fill up. j: place in a row of 8.
template <std::size_t kColumns, class Body>
HWY_INLINE void for_rows(const std::array<const double*, kColumns>& arrays, std::size_t count,
                         Body&& body) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::array<const double*, kColumns> at = arrays;
  std::size_t i = 0;
  for (; i + kParts <= count; i += kParts) {
    for (std::size_t j = 0; j < kParts; j += lanes) {
      for (std::size_t k = 0; k < kColumns; ++k) at[k] = arrays[k] + i + j;
      body(j, at);
    }
  }
  if (i == count) return;
  double rest[kColumns][kParts] = {};
  for (std::size_t k = 0; k < kColumns; ++k) std::copy(arrays[k] + i, arrays[k] + count, rest[k]);
  for (std::size_t j = 0; j < kParts; j += lanes) {
    for (std::size_t k = 0; k < kColumns; ++k) at[k] = rest[k] + j;
    body(j, at);
  }
}

void to_cells_lanes(const WeighedPoses& poses, double scale, double offset_x, double offset_y,
                    const CellPoses& cells) {
  const Tag d;
  const hn::Rebind<float, Tag> df;
  const std::size_t lanes = hn::Lanes(d);
  const auto row = [&](const double* x, const double* y, const double* theta, float* out_x,
                       float* out_y, float* out_c, float* out_s) {
    const auto factor = hn::Set(d, scale);
    Lanes s;
    Lanes c;
    sin_cos(d, hn::LoadU(d, theta), s, c);
    const auto u = hn::Add(hn::Mul(hn::LoadU(d, x), factor), hn::Set(d, offset_x));
    const auto v = hn::Add(hn::Mul(hn::LoadU(d, y), factor), hn::Set(d, offset_y));
    hn::StoreU(hn::DemoteTo(df, u), df, out_x);
    hn::StoreU(hn::DemoteTo(df, v), df, out_y);
    hn::StoreU(hn::DemoteTo(df, c), df, out_c);
    hn::StoreU(hn::DemoteTo(df, s), df, out_s);
  };
  std::size_t i = 0;
  for (; i + lanes <= poses.count; i += lanes) {
    row(poses.x_m + i, poses.y_m + i, poses.theta_rad + i, cells.x + i, cells.y + i,
        cells.cosine + i, cells.sine + i);
  }
  if (i == poses.count) return;
  double rest[3][kParts] = {};
  std::copy(poses.x_m + i, poses.x_m + poses.count, rest[0]);
  std::copy(poses.y_m + i, poses.y_m + poses.count, rest[1]);
  std::copy(poses.theta_rad + i, poses.theta_rad + poses.count, rest[2]);
  float out[4][kParts] = {};
  row(rest[0], rest[1], rest[2], out[0], out[1], out[2], out[3]);
  const std::size_t left = poses.count - i;
  std::copy(out[0], out[0] + left, cells.x + i);
  std::copy(out[1], out[1] + left, cells.y + i);
  std::copy(out[2], out[2] + left, cells.cosine + i);
  std::copy(out[3], out[3] + left, cells.sine + i);
}

double greatest_log_lanes(const double* weight, const double* log_likelihood, std::size_t count) {
  const Tag d;
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const auto never = hn::Set(d, kNever);
  auto greatest = never;
  for_rows<2>({weight, log_likelihood}, count, [&](std::size_t, const auto& at) {
    const auto value = hn::LoadU(d, at[1]);
    // Comparisons with NaN are false, so the maximum never sees one.
    const auto counts = hn::And(hn::Gt(hn::LoadU(d, at[0]), hn::Zero(d)), hn::Gt(value, never));
    greatest = hn::Max(greatest, hn::IfThenElse(counts, value, never));
  });
  return hn::GetLane(hn::MaxOfLanes(d, greatest));
}

double multiply_weights_lanes(const double* log_likelihood, double greatest, double* weight,
                              std::size_t count) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto most = hn::Set(d, greatest);
  Parts<1> sum;
  const auto row = [&](std::size_t j, const double* log, double* w) {
    // A particle without weight may have a greater log-likelihood than all others.
    const auto off = hn::Sub(hn::LoadU(d, log), most);
    const auto factor = exp_of(d, hn::IfThenElse(hn::Gt(off, hn::Zero(d)), hn::Zero(d), off));
    const auto product = hn::Mul(hn::LoadU(d, w), factor);
    hn::StoreU(product, d, w);
    sum.add(0, j, product);
  };
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) row(i % kParts, log_likelihood + i, weight + i);
  if (i < count) {
    double rest[2][kParts] = {};
    std::copy(log_likelihood + i, log_likelihood + count, rest[0]);
    std::copy(weight + i, weight + count, rest[1]);
    row(i % kParts, rest[0], rest[1]);
    std::copy(rest[1], rest[1] + (count - i), weight + i);
  }
  return sum.total(0);
}

PoseSums sum_poses_lanes(const WeighedPoses& poses) {
  const Tag d;
  Parts<5> sums;
  for_rows<4>({poses.x_m, poses.y_m, poses.theta_rad, poses.weight}, poses.count,
              [&](std::size_t j, const auto& at) {
                const auto w = hn::LoadU(d, at[3]);
                Lanes s;
                Lanes c;
                sin_cos(d, hn::LoadU(d, at[2]), s, c);
                sums.add(0, j, w);
                sums.add(1, j, hn::Mul(w, hn::LoadU(d, at[0])));
                sums.add(2, j, hn::Mul(w, hn::LoadU(d, at[1])));
                sums.add(3, j, hn::Mul(w, c));
                sums.add(4, j, hn::Mul(w, s));
              });
  return {sums.total(0), sums.total(1), sums.total(2), sums.total(3), sums.total(4)};
}

SpreadSums sum_spread_lanes(const WeighedPoses& poses, const Pose2& mean) {
  const Tag d;
  Parts<6> sums;
  for_rows<4>({poses.x_m, poses.y_m, poses.theta_rad, poses.weight}, poses.count,
              [&](std::size_t j, const auto& at) {
                const auto w = hn::LoadU(d, at[3]);
                const auto x = hn::Sub(hn::LoadU(d, at[0]), hn::Set(d, mean.x));
                const auto y = hn::Sub(hn::LoadU(d, at[1]), hn::Set(d, mean.y));
                const auto t = wrap_lanes(d, hn::Sub(hn::LoadU(d, at[2]), hn::Set(d, mean.theta)));
                const auto wx = hn::Mul(w, x);
                const auto wy = hn::Mul(w, y);
                sums.add(0, j, hn::Mul(wx, x));
                sums.add(1, j, hn::Mul(wx, y));
                sums.add(2, j, hn::Mul(wy, y));
                sums.add(3, j, hn::Mul(wx, t));
                sums.add(4, j, hn::Mul(wy, t));
                sums.add(5, j, hn::Mul(hn::Mul(w, t), t));
              });
  return {sums.total(0), sums.total(1), sums.total(2), sums.total(3), sums.total(4), sums.total(5)};
}

double sum_of_lanes(const double* values, std::size_t count) {
  Parts<1> sum;
  for_rows<1>({values}, count,
              [&](std::size_t j, const auto& at) { sum.add(0, j, hn::LoadU(Tag(), at[0])); });
  return sum.total(0);
}

double sum_of_squares_lanes(const double* values, std::size_t count) {
  Parts<1> sum;
  for_rows<1>({values}, count, [&](std::size_t j, const auto& at) {
    const auto value = hn::LoadU(Tag(), at[0]);
    sum.add(0, j, hn::Mul(value, value));
  });
  return sum.total(0);
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(to_cells_lanes);
HWY_EXPORT(greatest_log_lanes);
HWY_EXPORT(multiply_weights_lanes);
HWY_EXPORT(sum_poses_lanes);
HWY_EXPORT(sum_spread_lanes);
HWY_EXPORT(sum_of_lanes);
HWY_EXPORT(sum_of_squares_lanes);

void to_cells(const WeighedPoses& poses, double scale, double offset_x, double offset_y,
              const CellPoses& cells) {
  HWY_DYNAMIC_DISPATCH(to_cells_lanes)(poses, scale, offset_x, offset_y, cells);
}
double greatest_log(const double* weight, const double* log_likelihood, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(greatest_log_lanes)(weight, log_likelihood, count);
}
double multiply_weights(const double* log_likelihood, double greatest, double* weight,
                        std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(multiply_weights_lanes)(log_likelihood, greatest, weight, count);
}
PoseSums sum_poses(const WeighedPoses& poses) {
  return HWY_DYNAMIC_DISPATCH(sum_poses_lanes)(poses);
}
SpreadSums sum_spread(const WeighedPoses& poses, const Pose2& mean) {
  return HWY_DYNAMIC_DISPATCH(sum_spread_lanes)(poses, mean);
}
double sum_of(const double* values, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(sum_of_lanes)(values, count);
}
double sum_of_squares(const double* values, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(sum_of_squares_lanes)(values, count);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
