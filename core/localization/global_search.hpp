// SPDX-License-Identifier: Apache-2.0
/// Where in the whole map a scan, or a map of the last few, may have been taken: branch and bound
/// over all places and headings (docs/theory/patch_localization.md, "Global search").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/likelihood_field.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/block_bounds.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::localization {

struct GlobalSearchConfig {
  double resolution_m = 0.1;
  double hit_stddev_m = 0.1;
  double hit_weight = 0.95;
  int max_points = 120;
  int levels = 2;
  double min_share = 0.75;
  int max_candidates = 100;
  double separation_m = 0.5;
  double separation_rad = 0.26;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("resolution_m", c.resolution_m,
            {.doc = "side of the squares that places are tried at, in whole cells of the map; a "
                    "heading moves a far end point by as much",
             .unit = "m",
             .min = 0.01,
             .max = 1.0});
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "spread of end points about obstacles", .unit = "m", .min = 0.01, .max = 1.0});
    v.field("hit_weight", c.hit_weight,
            {.doc = "share of beams that end at an obstacle of the map",
             .unit = "1",
             .min = 0.01,
             .max = 0.999});
    v.field("max_points", c.max_points,
            {.doc = "end points in use, spread evenly", .unit = "points", .min = 3, .max = 257});
    v.field("levels", c.levels,
            {.doc = "levels of the bounds above single places", .min = 0, .max = 6});
    v.field("min_share", c.min_share,
            {.doc = "places whose end points score less than this share of the best one's are no "
                    "candidates",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_candidates", c.max_candidates,
            {.doc = "never more", .unit = "places", .min = 1, .max = 10000});
    v.field("separation_m", c.separation_m,
            {.doc = "candidates nearer than this, and no further turned than the next, are one",
             .unit = "m",
             .min = 0.0});
    v.field("separation_rad", c.separation_rad,
            {.doc = "... turned against each other", .unit = "rad", .min = 0.0});
  }
};

/// A place where the end points fit.
struct PlaceCandidate {
  Pose2 map_from_robot;
  double score = 0.0;  ///< sum over end points of ln p less ln p far from obstacles [nats]
};

/// A table of one map. Const, so that several may search in it at once.
class GlobalSearch {
 public:
  /// map: obstacles where is_occupied; the robot stands where it is free. O(cells x levels).
  /// Memory: about 12 bytes a square, and 4 a cell of the map.
  explicit GlobalSearch(const ReflectionGrid& map, const GlobalSearchConfig& config = {});

  [[nodiscard]] const GlobalSearchConfig& config() const { return config_; }

  /// The places of a lattice of squares and headings where the end points (in the robot frame)
  /// score best, each then moved to where they fit best, best first: of every block of 2^levels
  /// squares and each heading the best place, of those that are nearer to each other than the
  /// separation the better one. The result is that of trying all places (branch and bound
  /// [hess2016real]). A score is made of end points alone: what tells candidates apart is a sensor
  /// model's to say. O(free blocks x headings x points), by vectors, and the blocks that may hold a
  /// candidate.
  [[nodiscard]] std::vector<PlaceCandidate> search(const Endpoints& endpoints) const;

  /// A place of the lattice.
  struct LatticePlace {
    int heading = 0;
    Cell square;              ///< from the corner of the map's rectangle
    std::uint32_t steps = 0;  ///< its score in steps of the table
  };
  /// The same before places are moved, in the lattice's own terms; for tests.
  [[nodiscard]] std::vector<LatticePlace> search_lattice(const Endpoints& endpoints) const;
  /// The score of every square at one heading, row by row, by looking each end point up; for tests.
  [[nodiscard]] std::vector<std::uint32_t> steps_at(const Endpoints& endpoints, int heading) const;
  [[nodiscard]] int headings(const Endpoints& endpoints) const;
  /// Whether the robot may stand in a square.
  [[nodiscard]] bool is_open(const Cell& square) const;
  [[nodiscard]] int squares_x() const { return squares_x_; }
  [[nodiscard]] int squares_y() const { return squares_y_; }

  /// Moves a pose to where the end points score best nearby (within about a square), and returns
  /// its score there [nats].
  double settle(const Endpoints& endpoints, Pose2& map_from_robot) const;

 private:
  struct Blocks;
  struct Lattice;
  [[nodiscard]] Lattice make_lattice(const Endpoints& endpoints) const;
  void sweep(const Lattice& lattice, Blocks& blocks) const;
  void best_in_block(const Lattice& lattice, LatticePlace& best, const Cell& square, int level,
                     std::uint32_t floor) const;
  [[nodiscard]] std::vector<LatticePlace> lattice_places(const Lattice& lattice) const;
  [[nodiscard]] Pose2 pose_of(const LatticePlace& place, int headings) const;
  [[nodiscard]] double score_at(const Endpoints& endpoints, const Pose2& pose) const;

  GlobalSearchConfig config_;
  LikelihoodField field_;
  double least_ = 0.0;  // of the field [nats]
  double side_m_ = 0.1;
  int squares_x_ = 0;
  int squares_y_ = 0;
  Cell corner_;  // of the map's rectangle, in squares of the lattice
  std::vector<std::uint8_t> open_;
  std::vector<BlockBounds> bounds_;  // one; none for an empty map
  struct Range {
    int begin = 0;
    int end = 0;
  };
  std::vector<Range> open_blocks_;  // of each row of blocks, from the first to the last
  std::vector<std::uint8_t> open_block_;
};

/// At most max_points of the end points, spread over space: thinned to one a square of `spacing_m`,
/// and evenly then.
[[nodiscard]] Endpoints spread_out(const Endpoints& endpoints, double spacing_m,
                                   std::size_t max_points);

}  // namespace strata::localization
