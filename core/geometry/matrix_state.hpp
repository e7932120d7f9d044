// SPDX-License-Identifier: Apache-2.0
/// Matrices of a fixed size, and Gaussians, in saved states (core/base/state_archive.hpp).
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "core/base/state_archive.hpp"
#include "core/geometry/pose2_gaussian.hpp"

namespace strata {

template <typename Scalar, int kRows, int kCols, typename Archive>
void state_of(const Eigen::Matrix<Scalar, kRows, kCols>& matrix, Archive& archive) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) archive(matrix.data()[i]);
}
template <typename Scalar, int kRows, int kCols, typename Archive>
void state_of(Eigen::Matrix<Scalar, kRows, kCols>& matrix, Archive& archive) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) archive(matrix.data()[i]);
}

template <class Value, class Archive>
requires std::is_same_v<std::remove_const_t<Value>, Pose2Gaussian>
void state_of(Value& gaussian, Archive& archive) {
  archive(gaussian.mean);
  archive(gaussian.covariance);
}

}  // namespace strata
