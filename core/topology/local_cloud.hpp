// SPDX-License-Identifier: Apache-2.0
/// The local cloud around one visit of a landmark: surface points with normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/scan/scan.hpp"

namespace strata::topology {

struct LocalCloudConfig {
  double path_radius_m = 3.0;
  double point_radius_m = 6.0;
  double cell_m = 0.1;
  int neighbours = 5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("path_radius_m", c.path_radius_m,
            {.doc = "scans taken this near the landmark make its local cloud",
             .unit = "m",
             .min = 0.1});
    v.field("point_radius_m", c.point_radius_m,
            {.doc = "points this near the landmark belong to it", .unit = "m", .min = 0.5});
    v.field("cell_m", c.cell_m,
            {.doc = "points are averaged over cells of this size", .unit = "m", .min = 0.01});
    v.field("neighbours", c.neighbours, {.doc = "points that a normal is fitted to", .min = 2});
  }
};

/// Points and unit normals (of either sign) in the frame of the visit; equal lengths.
struct LocalCloud {
  std::vector<Eigen::Vector2d> points_m;
  std::vector<Eigen::Vector2d> normals;

  [[nodiscard]] std::size_t size() const { return points_m.size(); }
  [[nodiscard]] bool empty() const { return points_m.empty(); }
};

/// Whether it has a normal for each point, and all of them are finite. O(points).
[[nodiscard]] bool is_sound(const LocalCloud& cloud);

/// Points with normals by principal axes of each point and its nearest neighbours. Points that are
/// not finite or have no neighbour within a metre are left out. O(n log n) about.
[[nodiscard]] LocalCloud with_normals(std::span<const Eigen::Vector2d> points_m, int neighbours);

/// The hits of all scans within the radii of the config, subsampled. scans: map_from_robot in any
/// common frame; landmark: the visit's pose in that frame.
[[nodiscard]] LocalCloud make_local_cloud(std::span<const PosedScan> scans, const Pose2& landmark,
                                          const LocalCloudConfig& config);

/// Nearest points within a fixed reach, by buckets.
class NearestPoint {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// reach_m > 0; keeps a reference to the points.
  NearestPoint(const std::vector<Eigen::Vector2d>& points_m, double reach_m);
  /// Index of the nearest point within min(reach_m, gate_m), or kNone; the first of equals. hint:
  /// a point that may be near, which makes it faster.
  [[nodiscard]] std::size_t find(const Eigen::Vector2d& at, double gate_m,
                                 std::size_t hint = kNone) const;
  /// Indices of all points within the reach, in no particular order; replaces `found`.
  void within(const Eigen::Vector2d& at, std::vector<std::size_t>& found) const;

 private:
  static constexpr int kCellsPerReach = 4;
  template <typename Visit>
  void for_row(int y, int from_x, int to_x, Visit&& visit) const;
  [[nodiscard]] std::optional<Eigen::Vector2i> cell_of(const Eigen::Vector2d& at) const;
  const std::vector<Eigen::Vector2d>& points_m_;
  double reach_m_;
  double cell_m_;
  Eigen::Vector2d min_{0.0, 0.0};
  int width_ = 0;
  int height_ = 0;
  std::vector<std::size_t> begin_;  // of each bucket in order_
  std::vector<std::size_t> order_;
};

/// A cloud made ready to register others to. Keeps a reference to it.
class PlaceSurface {
 public:
  /// reach_m > 0: nothing further away counts.
  PlaceSurface(const LocalCloud& cloud, double reach_m);
  [[nodiscard]] const LocalCloud& cloud() const { return cloud_; }
  /// Index of the nearest point within gate_m, or NearestPoint::kNone; the first of equals. The
  /// table tells where there is none.
  [[nodiscard]] std::size_t find(const Eigen::Vector2d& at, double gate_m) const {
    const std::size_t about = in_table(at);
    if (about == NearestPoint::kNone) return about;
    const double no_nearer_m = (cloud_.points_m[about] - at).norm() - kTableErrorM;
    return no_nearer_m > gate_m ? NearestPoint::kNone : exact_.find(at, gate_m, about);
  }
  /// Index of a point about as near as the nearest, within gate_m; NearestPoint::kNone: none. One
  /// look into a table: right up to a cell of kCellM.
  [[nodiscard]] std::size_t find_about(const Eigen::Vector2d& at, double gate_m) const {
    const std::size_t about = in_table(at);
    if (about == NearestPoint::kNone) return about;
    const bool near = (cloud_.points_m[about] - at).squaredNorm() <= gate_m * gate_m;
    return near ? about : NearestPoint::kNone;
  }

 private:
  static constexpr double kCellM = 0.1;
  static constexpr double kTableErrorM = kCellM * 1.4143;  // twice half a cell's diagonal
  /// What is nearest to the middle of the cell; every point within the reach of the cell is there.
  [[nodiscard]] std::size_t in_table(const Eigen::Vector2d& at) const {
    const double x = (at.x() - min_.x()) / kCellM;
    const double y = (at.y() - min_.y()) / kCellM;
    if (!(x >= 0.0 && y >= 0.0 && x < width_ && y < height_)) return NearestPoint::kNone;
    const std::int32_t i = nearest_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(x)];
    return i < 0 ? NearestPoint::kNone : static_cast<std::size_t>(i);
  }
  const LocalCloud& cloud_;
  NearestPoint exact_;
  Eigen::Vector2d min_{0.0, 0.0};
  int width_ = 0;
  int height_ = 0;
  std::vector<std::int32_t> nearest_;  // of each cell; -1: none
};

}  // namespace strata::topology
