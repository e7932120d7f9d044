// SPDX-License-Identifier: Apache-2.0
/// Consistent poses from relative measurements [lu1997globally]: nodes are poses, edges are
/// measured transforms with their information.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"

namespace strata::pose_graph {

/// A measurement of pose `to` seen from pose `from`: from_from_to, with information (inverse
/// covariance) of (x, y, theta) in frame `from`.
struct Edge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose2 from_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  /// True: the measurement may be wrong as a whole (a loop closure); its pull fades with its
  /// error. False: Gaussian.
  bool robust = false;

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.from);
    archive(self.to);
    archive(self.from_from_to);
    archive(self.information);
    archive(self.robust);
  }
};

/// What is known about one pose by itself.
struct Prior {
  std::size_t node = 0;
  Pose2 map_from_node;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  bool robust = false;

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.node);
    archive(self.map_from_node);
    archive(self.information);
    archive(self.robust);
  }
};

struct PoseGraphConfig {
  int max_iterations = 50;
  double robust_scale = 3.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_iterations", c.max_iterations,
            {.doc = "iterations of one optimization, at most", .min = 1});
    v.field("robust_scale", c.robust_scale,
            {.doc = "error at which the pull of a robust edge begins to fade (Cauchy)",
             .unit = "standard deviations",
             .min = 0.1});
  }
};

struct PoseGraphResult {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0.0;  ///< half the sum of squared whitened errors, after robustification
  double final_cost = 0.0;
};

/// A growing pose graph. Not thread-safe; two graphs are independent.
class PoseGraph {
 public:
  explicit PoseGraph(const PoseGraphConfig& config = {});

  /// The next node, edge and prior ask for no memory. Throws std::bad_alloc.
  void make_room();
  /// Adds a pose with its first estimate, map_from_node; returns its index. A fixed node does not
  /// move; without a fixed node or a prior, node 0 of each connected part is held.
  std::size_t add_node(const Pose2& map_from_node, bool fixed = false);
  /// Requires existing nodes, from != to and a symmetric positive definite information.
  std::size_t add_edge(const Edge& edge);
  void add_prior(const Prior& prior);
  /// Takes an edge out of later optimizations (a closure found to be wrong).
  void disable_edge(std::size_t edge) { enabled_[edge] = false; }
  [[nodiscard]] bool edge_enabled(std::size_t edge) const { return enabled_[edge]; }

  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  [[nodiscard]] const Pose2& pose(std::size_t node) const { return poses_[node]; }
  void set_pose(std::size_t node, const Pose2& map_from_node) { poses_[node] = map_from_node; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Squared Mahalanobis error of an edge at the present poses (3 degrees of freedom).
  [[nodiscard]] double squared_error(std::size_t edge) const;

  /// Moves the poses to the least squared error; sparse Levenberg-Marquardt on one thread, so the
  /// result is the same everywhere. O(iterations x fill-in).
  PoseGraphResult optimize();

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.poses_);
    archive(self.fixed_);
    archive(self.edges_);
    archive(self.enabled_);
    archive(self.priors_);
  }
  /// Whether every edge and prior is of poses that are there; else a state was damaged.
  [[nodiscard]] bool is_sound() const;

 private:
  [[nodiscard]] std::vector<bool> held_nodes() const;
  PoseGraphConfig config_;
  std::vector<Pose2> poses_;
  std::vector<bool> fixed_;
  std::vector<Edge> edges_;
  std::vector<bool> enabled_;
  std::vector<Prior> priors_;
};

/// Error of an edge, (from_from_to measured)^-1 applied in frame `from`: translation difference in
/// frame `from`, heading difference wrapped. Jacobians (row-major 3 x 3) where not null.
[[nodiscard]] Eigen::Vector3d edge_error(const Pose2& map_from_a, const Pose2& map_from_b,
                                         const Pose2& a_from_b, Eigen::Matrix3d* by_a = nullptr,
                                         Eigen::Matrix3d* by_b = nullptr);

}  // namespace strata::pose_graph
