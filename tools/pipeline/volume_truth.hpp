// SPDX-License-Identifier: Apache-2.0
/// How much of what moved is gone from a 3-D map, where clouds come with the truth.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::pipeline {

struct VolumeScore {
  std::size_t moving_voxels = 0;  ///< in which points on what moves ended, and no other
  std::size_t moving_made = 0;    ///< of these, occupied in the map of all points
  std::size_t moving_left = 0;    ///< of these, occupied in the filtered map
  std::size_t static_voxels = 0;  ///< occupied in the map without points on what moves
  std::size_t static_lost = 0;    ///< of these, not occupied in the filtered map

  [[nodiscard]] double gone() const {
    return moving_made == 0
               ? 1.0
               : 1.0 - static_cast<double>(moving_left) / static_cast<double>(moving_made);
  }
  [[nodiscard]] double lost() const {
    return static_voxels == 0
               ? 0.0
               : static_cast<double>(static_lost) / static_cast<double>(static_voxels);
  }
};

/// Makes two more maps beside the filtered one: of all points, and of those that truly stand still.
class VolumeTruth {
 public:
  explicit VolumeTruth(const volume::VolumeConfig& config) : raw_(config), still_(config) {}

  /// A cloud without truth is ignored.
  void add(const volume::Cloud& cloud, WorkerPool& pool);
  /// Nothing when no cloud had truth. O(voxels).
  [[nodiscard]] std::optional<VolumeScore> score(const volume::VolumeMap& filtered) const;

 private:
  struct Ends {
    std::array<std::uint64_t, 8> moving{};
    std::array<std::uint64_t, 8> still{};
  };
  volume::VolumeMap raw_;
  volume::VolumeMap still_;
  volume::BrickMap<Ends> ends_;
};

}  // namespace strata::pipeline
