// SPDX-License-Identifier: Apache-2.0
/// A scan as it would look from a node close by [kessler2010what, eqs. (1) and (2)].
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "memory/levels/polar_bins.hpp"

namespace strata::memory {

/// What of a scan counts as known.
struct VisibilityConfig {
  /// The robot has come from somewhere: where no beam looks, the ground this far around the laser
  /// is taken as free. Without it a scanner of 180 degrees could never fill a node behind it.
  double own_place_m = 1.1;
  /// Beams further apart than this leave the ground between them unknown.
  double max_gap_rad = 0.06;
  /// A bin between two neighbouring beams takes the range of the line between their points, if
  /// both lie on one surface: the beams would meet the line at no less than `min_incidence_rad`.
  /// Without it a scanner with wider gaps than an angle bin would leave the bins between its beams
  /// empty, and would never give a pair of neighbours. [kessler2010what] has a beam for each bin.
  bool fill_between_beams = true;
  double min_incidence_rad = 0.175;
  /// A beam without return says that nothing is there up to the scanner's greatest range. Within
  /// max_range_m it does so only where that is known (tells_reach), for three such beams in a row,
  /// and in scans whose returns do not drop out by themselves (drops_returns).
  bool trust_no_return = true;
  /// Beams that the beam filter gives a smaller probability of being static are left out; 0: none.
  double min_static_probability = 0.0;

  friend bool operator==(const VisibilityConfig&, const VisibilityConfig&) = default;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("own_place_m", c.own_place_m,
            {.doc = "radius around the laser that is free where no beam looks",
             .unit = "m",
             .min = 0.0});
    v.field("max_gap_rad", c.max_gap_rad,
            {.doc = "beams further apart leave unknown ground between them",
             .unit = "rad",
             .min = 0.0});
    v.field("fill_between_beams", c.fill_between_beams,
            {.doc = "bins between two beams on one surface take the range in between",
             .preset = {"paper-timescale", "false"}});
    v.renamed("least_incidence_rad", "min_incidence_rad");
    v.field("min_incidence_rad", c.min_incidence_rad,
            {.doc = "... unless beams would graze that surface at less than this",
             .unit = "rad",
             .min = 0.001,
             .max = 1.5});
    v.field("trust_no_return", c.trust_no_return,
            {.doc = "a beam without return means free space up to the scanner's greatest range"});
    v.field("min_static_probability", c.min_static_probability,
            {.doc = "leave out beams less likely static than this; 0: keep all",
             .min = 0.0,
             .max = 1.0});
  }
};

/// Per angle bin the range in metres from the node; +Inf for "at least max_range_m"; -f for "no
/// nearer than f", f < max_range_m, where beams ended without return; NaN where the scan says
/// nothing.
using VirtualScan = std::vector<float>;

/// Whether returns of the scan drop out by themselves, so that a beam without one says nothing: of
/// the beams between two that hit one surface (within a tenth of their range, the outer two and the
/// one between) more than a twentieth returned nothing. O(beams).
[[nodiscard]] bool drops_returns(const Scan& scan);

/// Turns scans into virtual scans; keeps its scratch memory. One thread at a time.
///
/// With p a beam's end point, v = p - x_node, the range is |v| and the bearing atan2(v_y, v_x): the
/// paper adds x_n - x_r and uses atan, which gives the wrong side and loses the quadrant. A point
/// counts only if the node would see it: the node must lie inside the star polygon of the scan, and
/// the way from node to point must stay inside it, to within one bin. Of several points in an angle
/// bin the nearest counts; a bin between two points of one surface takes the range of the line that
/// joins them. Where beams reach max_range_m without a point, the bin overflows; where they end
/// without return before that, nothing is nearer than their ends, less one range bin.
class VirtualScanner {
 public:
  VirtualScanner(const PolarBins& bins, const VisibilityConfig& config);

  /// Returns whether the node lies inside the scan's polygon; if not, `result` is all NaN.
  /// O(beams + angle bins).
  bool transform(const PosedScan& scan, const Eigen::Vector2d& node_m, VirtualScan& result);

 private:
  /// A corner of the polygon, relative to the node.
  struct Vertex {
    double x_m = 0.0;
    double y_m = 0.0;
    bool is_hit = false;
    /// This corner and the next are hits of neighbouring beams on one surface.
    bool joins_next = false;
    /// No beam's end, but the edge of the ground that is taken as free where no beam looks.
    bool is_own_place = false;
    /// The end of a beam that nothing came back from, and that is taken at its word.
    bool is_free_end = false;
  };
  /// An edge of the polygon.
  enum class Boundary : unsigned char {
    kBetween,  ///< beams that end at two surfaces, or at none
    kSurface,  ///< two hits on one surface
    kReach,    ///< two beams without return
    kUnseen,   ///< no beam looks there
  };
  void build_polygon(const PosedScan& scan, const Eigen::Vector2d& node_m);
  void add_unknown_sector(const Eigen::Vector2d& laser_m, double from_rad, double to_rad);
  [[nodiscard]] bool node_is_inside() const;
  /// Marks corners that belong to one surface with the next, as seen from the laser.
  void join_surfaces(const Eigen::Vector2d& laser_m);
  /// Leaves only free ends that stand in a row.
  void doubt_lone_free_ends();
  void measure_boundary();

  PolarBins bins_;
  VisibilityConfig config_;
  std::vector<double> cos_;  ///< of each bin's centre
  std::vector<double> sin_;
  std::vector<Vertex> polygon_;     ///< counter-clockwise about the laser
  std::vector<double> angle_;       ///< of each corner about the node, in bins, [0, angle_bins)
  std::vector<double> boundary_m_;  ///< first crossing of the polygon along each bin's centre
  std::vector<Boundary> boundary_;  ///< ... and what is there
};

}  // namespace strata::memory
