// SPDX-License-Identifier: Apache-2.0
/// What is known of a chunk of particles before its beams are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/localization/particle_set.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"

namespace strata::patch_beams {

/// What particles of a chunk know of where they are.
struct ChunkStates {
  std::span<const std::int32_t> submap;  ///< which they are in, -1: none
  std::span<const std::int32_t> patch;   ///< its one configuration that counts; empty: all count
  [[nodiscard]] std::int32_t fixed(std::size_t n) const { return patch.empty() ? -1 : patch[n]; }
};

/// Those of particles [begin, end). Without memory a particle's own configuration counts.
[[nodiscard]] ChunkStates chunk_states(const localization::PatchStates& states,
                                       const localization::ParticleSet& particles,
                                       std::size_t begin, std::size_t end);

/// What the particles of a chunk believe of all sub-maps: a row for each, or one for all.
struct BeliefRows {
  const float* rows = nullptr;
  std::size_t columns = 0;  ///< all
  std::size_t stride = 0;   ///< from one particle to the next; 0: one row for all
  [[nodiscard]] std::span<const float> of(std::size_t particle) const {
    return {rows + particle * stride, columns};
  }
};

/// Those of particles from `begin` on; valid as long as the particles are left alone.
[[nodiscard]] BeliefRows belief_rows(const localization::PatchStates& states,
                                     const localization::ParticleSet& particles, std::size_t begin);

/// The map and what the particles know of it: what every stage behind the rays reads.
struct PatchChunk {
  const PatchRayCaster& caster;
  const localization::PatchStates& layout;
  ChunkStates states;
  BeliefRows beliefs;
  std::size_t bundles = 0;              ///< entries of a row of beams, LaserColumns::padded()
  bool expects_something_else = false;  ///< in this scan

  [[nodiscard]] std::size_t size() const { return states.submap.size(); }
  [[nodiscard]] bool has_memory() const {
    return layout.memory() != localization::PatchMemory::kNone;
  }
  [[nodiscard]] bool may_show_something_else(std::int32_t submap) const {
    return expects_something_else && layout.something_else(static_cast<std::size_t>(submap)) > 0.0F;
  }
  /// Rows of SubmapRatios: its configurations, and behind them something else, where beams pass the
  /// cells that change.
  [[nodiscard]] std::size_t rows(std::int32_t submap) const {
    return static_cast<std::size_t>(layout.count(static_cast<std::size_t>(submap))) +
           (may_show_something_else(submap) ? 1 : 0);
  }
  /// Whether its configurations are mixed for the scan as a whole: with a memory those of the
  /// particle's own sub-map, and of each that may show something else.
  [[nodiscard]] bool mixes_whole(std::int32_t submap, bool is_own) const {
    return has_memory() && (is_own || may_show_something_else(submap));
  }
  /// What a particle believes of one sub-map.
  [[nodiscard]] const float* belief(std::size_t particle, std::int32_t submap) const {
    return beliefs.of(particle).data() + layout.offset(static_cast<std::size_t>(submap));
  }
};

}  // namespace strata::patch_beams
