// SPDX-License-Identifier: Apache-2.0
/// The loops over particles, with the widest SIMD that the machine has. Every SIMD target and the
/// fall-back without SIMD give the same bits: operations come in a fixed order without fused
/// multiply-adds, and sums are made of eight partial sums by index modulo 8.
#pragma once

#include <cstddef>

#include "core/geometry/pose2.hpp"

namespace strata::localization {

/// Columns of poses, map_from_robot; `count` numbers each.
struct PoseColumns {
  double* x_m = nullptr;
  double* y_m = nullptr;
  double* theta_rad = nullptr;
  std::size_t count = 0;
};
/// The same to read, with weights where a function uses them.
struct WeighedPoses {
  const double* x_m = nullptr;
  const double* y_m = nullptr;
  const double* theta_rad = nullptr;
  const double* weight = nullptr;
  std::size_t count = 0;
};

/// x[i], y[i] = position of pose i * scale + offset; c[i], s[i] = cosine and sine of its heading.
struct CellPoses {
  float* x = nullptr;
  float* y = nullptr;
  float* cosine = nullptr;
  float* sine = nullptr;
};
void to_cells(const WeighedPoses& poses, double scale, double offset_x, double offset_y,
              const CellPoses& cells);

/// The greatest log-likelihood of a particle with weight; -infinity when there is none, NaN
/// ignored.
[[nodiscard]] double greatest_log(const double* weight, const double* log_likelihood,
                                  std::size_t count);
/// weight[i] *= exp(log_likelihood[i] - greatest), 0 where that is below exp(-700) or NaN; returns
/// the sum of the new weights.
double multiply_weights(const double* log_likelihood, double greatest, double* weight,
                        std::size_t count);

/// Weighted sums: of the weights, x, y, cosine and sine.
struct PoseSums {
  double weight = 0.0, x = 0.0, y = 0.0, cosine = 0.0, sine = 0.0;
};
[[nodiscard]] PoseSums sum_poses(const WeighedPoses& poses);
/// Weighted sums of the products of deviations from `mean`, headings wrapped.
struct SpreadSums {
  double xx = 0.0, xy = 0.0, yy = 0.0, xt = 0.0, yt = 0.0, tt = 0.0;
};
[[nodiscard]] SpreadSums sum_spread(const WeighedPoses& poses, const Pose2& mean);

/// Sum of values, and of their squares, in eight partial sums. Plain loops, here so that all sums
/// over particles are made alike.
[[nodiscard]] double sum_of(const double* values, std::size_t count);
[[nodiscard]] double sum_of_squares(const double* values, std::size_t count);

}  // namespace strata::localization
