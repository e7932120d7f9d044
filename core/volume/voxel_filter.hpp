// SPDX-License-Identifier: Apache-2.0
/// Which points of 3-D scans hit something that moves: the EM beam filter [stachniss2003chapter,
/// section 1.2] on voxels, without a 2-D scanner (docs/theory/static_3d.md, "Voxel filter").
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/cloud.hpp"
#include "core/volume/cloud_evidence.hpp"

namespace strata::volume {

struct VoxelFilterConfig {
  /// Lower than that of beams, chosen on simulated rooms: a 3-D log holds few clouds, so that who
  /// waits through a few is seen in many of them.
  double prior = 0.54;
  double static_clouds = 12.0;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "prior", c.prior,
        {.doc = "probability that a point lies on something static; a voxel is taken for moving "
                "when at most about twice (1 - prior) of the clouds that saw it ended in it",
         .unit = "1",
         .min = 0.501,
         .max = 0.999});
    v.field("static_clouds", c.static_clouds,
            {.doc = "so many clouds count as having ended in every voxel beside those that did: "
                    "where few looked, more of them must have passed",
             .min = 0.0});
  }
};

/// How many clouds passed a voxel, and from where: the sum of d d^T over their unit directions d.
/// Its trace is their number, so that zz need not be kept.
struct Passes {
  static constexpr int kUnit = 32;  ///< of the sums; room for 1,000 clouds
  std::uint16_t clouds = 0;
  std::int16_t xx = 0;
  std::int16_t yy = 0;
  std::int16_t xy = 0;
  std::int16_t xz = 0;
  std::int16_t yz = 0;
};

/// How often clouds ended in the voxels of a brick, and passed them without ending there. Both are
/// halved where one is full, which leaves their share as it is.
struct BrickCounts {
  static constexpr std::uint16_t kFull = 1000;
  std::array<std::uint16_t, kBrickVoxels> ended{};
  std::array<Passes, kBrickVoxels> passed{};
};

/// Two rounds over a log: `count` every cloud, then `label` every cloud.
class VoxelFilter {
 public:
  /// Throws ConfigError.
  VoxelFilter(const VoxelFilterConfig& config, const VoxelLattice& lattice,
              const RayLimits& limits);

  /// A voxel counts once a cloud, as in VolumeMap::insert: single beams of one cloud are no
  /// independent evidence; and rays that graze a surface count as CloudEvidence counts them. Both
  /// depart from the paper, which counts beams. O(voxels passed).
  void count(const Cloud& cloud, WorkerPool& pool);

  /// P(c = 1) of a point that ends in a voxel, eq. (1.10) at the limit of EM: with h clouds that
  /// ended there, static_clouds among them, and f that passed, m maximizes
  /// h ln[(1 - p) + (2 p - 1) m] + f ln(1 - m). A cloud that looks along the surface about the
  /// voxel counts for less in f. The prior where nothing was counted. O(voxels about it).
  [[nodiscard]] double static_probability(const VoxelKey& key) const;

  /// A flag a point: 1 where its end has a static probability below one half. Points beyond the
  /// range, outside the box, or not finite get 0. O(points).
  [[nodiscard]] std::vector<std::uint8_t> label(const Cloud& cloud, WorkerPool& pool) const;

  [[nodiscard]] std::size_t bytes() const { return counts_.bytes(); }

 private:
  [[nodiscard]] const BrickCounts* counts_at(const VoxelKey& key) const;
  [[nodiscard]] double probability_of(double ended, double passed) const;
  /// Whether the static probability is below one half.
  [[nodiscard]] bool is_dynamic(const VoxelKey& key) const;
  /// f: each direction d counts d^T W d, W = I - (C - c I) / C's largest eigenvalue, c its smallest
  /// one, C the covariance of what was ended in about the voxel. 1 across a surface or a pole, 0
  /// along it, 1 everywhere in what is thick to all sides.
  [[nodiscard]] double passed_across(const VoxelKey& key, const Passes& passes) const;
  VoxelFilterConfig config_;
  VoxelLattice lattice_;
  RayLimits limits_;
  CloudEvidence evidence_;  ///< of the present cloud
  BrickMap<BrickCounts> counts_;
};

}  // namespace strata::volume
