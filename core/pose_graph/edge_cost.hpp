// SPDX-License-Identifier: Apache-2.0
/// The error of an edge as Ceres wants it, for those that put graphs of their own together.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"

namespace ceres {
class CostFunction;
}

namespace strata::pose_graph {

/// root * edge_error between two parameter blocks (x, y, theta), with its Jacobians. root' * root:
/// the information of the edge. The caller owns it.
[[nodiscard]] ceres::CostFunction* new_edge_cost(const Pose2& a_from_b,
                                                 const Eigen::Matrix3d& root);

}  // namespace strata::pose_graph
