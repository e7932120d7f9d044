// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/random/stream.hpp"

namespace strata::test {

/// A block of nine independent numbers.
inline Eigen::Matrix3d random_block(RandomStream& random) {
  Eigen::Matrix3d block;
  for (int i = 0; i < 9; ++i) block(i / 3, i % 3) = random.normal(0.0, 1.0);
  return block;
}

}  // namespace strata::test
