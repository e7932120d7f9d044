// SPDX-License-Identifier: Apache-2.0
/// Colours of a 3-D map from the pictures that show only what stands still
/// [stachniss2003chapter, section 1.5.1] (docs/theory/static_3d.md, "Colours").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"
#include "core/scan/scan.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/camera.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

struct ColorConfig {
  double window_s = 0.25;
  double margin_m = 0.4;
  double highest_m = 2.2;
  double tie_nats = 0.5;
  double min_static = 0.5;
  double max_range_m = 15.0;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("window_s", c.window_s,
            {.doc = "2-D beams this much before or after an image speak for it",
             .unit = "s",
             .min = 0.0});
    v.field("margin_m", c.margin_m,
            {.doc = "what a 2-D beam hit hides lines of sight this near to it, from the floor up",
             .unit = "m",
             .min = 0.0});
    v.field("highest_m", c.highest_m, {.doc = "up to this height", .unit = "m"});
    v.field("tie_nats", c.tie_nats,
            {.doc = "log likelihoods nearer than this are alike: then the most frontal view counts",
             .unit = "nats",
             .min = 1e-6});
    v.renamed("least_static", "min_static");
    v.field("min_static", c.min_static,
            {.doc = "a view less likely than this to show static things only colours nothing; 0: "
                    "the best view always does, as in the paper",
             .min = 0.0,
             .max = 1.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "voxels further from the camera get no colour", .unit = "m", .min = 0.1});
  }
};

/// What a beam that may have hit something moving says: a place in the plane, from the floor up.
struct MovingWitness {
  Stamp stamp;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double log_static = 0.0;  ///< ln e, e the probability that it hit something static
};
/// The ends of hits with e below 0.95, by stamp: surer ones change no choice and are left out.
/// O(beams log beams).
[[nodiscard]] std::vector<MovingWitness> moving_witnesses(std::span<const PosedScan> scans);

/// A picture and where it was taken from (optical frame).
struct CameraView {
  Stamp stamp;
  Pose3 map_from_camera;
  Camera camera;
  const ColorImage* image = nullptr;
};

/// An occupied voxel and what is known of its colour.
struct ColoredVoxel {
  VoxelKey key;
  float log_odds = 0.0F;
  /// In units of tie_nats; a voxel that no view showed has the least.
  std::int32_t likelihood = std::numeric_limits<std::int32_t>::min();
  float frontality = 0.0F;  ///< cosine between its normal and the view, of the view it took
  std::int32_t view = -1;   ///< which of those offered that was, from 0
  Rgb color = kGrey;
  [[nodiscard]] bool is_seen() const {
    return likelihood != std::numeric_limits<std::int32_t>::min();
  }
};

/// Colours the occupied voxels of a map. Each takes the view with the greatest sum of ln e over the
/// beams whose upright column, margin_m thick, its line of sight passes: the paper's choice for a
/// polygon, made for a voxel, with columns in space instead of end points in the picture, since a
/// person hides more than what a planar scanner sees of him. Among views alike, the most frontal.
/// Unlike the paper, no view is better than one that likely shows a person (min_static).
class ColorMap {
 public:
  /// Throws ConfigError. witnesses: by stamp.
  ColorMap(const ColorConfig& config, const VolumeMap& map, std::vector<MovingWitness> witnesses);

  /// Offers a picture to every voxel that it shows: within range, with no occupied voxel before
  /// it. Order of views and number of threads do not matter, but for views that are alike in all.
  /// Returns how many voxels it shows. O(voxels x (ray + witnesses of its moment)).
  std::size_t add(const CameraView& view, WorkerPool& pool);

  [[nodiscard]] const std::vector<ColoredVoxel>& voxels() const { return voxels_; }
  /// Paints all voxels by height instead: blue low, red high.
  void color_by_height();
  /// A .ot file of OctoMap's ColorOcTree with the log odds of the map; voxels without colour are
  /// grey, and so are those that the map has only since it was given.
  [[nodiscard]] std::string file(const VolumeMap& map) const;

 private:
  using Bits = std::array<std::uint64_t, 8>;
  [[nodiscard]] bool is_occupied(const VoxelKey& key) const;
  [[nodiscard]] Eigen::Vector3f normal_of(const VolumeMap& map, const VoxelKey& key) const;
  [[nodiscard]] bool is_visible(const Eigen::Vector3f& from_m, const VoxelKey& key) const;
  [[nodiscard]] double log_likelihood(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                                      std::span<const MovingWitness> witnesses) const;
  /// Whether the voxel is shown.
  bool offer(const CameraView& view, const Pose3& camera_from_map,
             std::span<const MovingWitness> witnesses, std::size_t voxel);

  ColorConfig config_;
  VoxelLattice lattice_;
  std::vector<MovingWitness> witnesses_;
  BrickMap<Bits> occupied_;
  std::vector<ColoredVoxel> voxels_;
  std::vector<Eigen::Vector3f> normals_;  ///< one a voxel, 0 where free space is all around
  std::int32_t offered_ = 0;              ///< views
};

/// Blue low, over green, to red high; `share` in [0, 1].
[[nodiscard]] Rgb height_rgb(double share);

}  // namespace strata::volume
