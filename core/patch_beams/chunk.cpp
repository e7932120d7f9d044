// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/chunk.hpp"

namespace strata::patch_beams {

using localization::PatchMemory;

ChunkStates chunk_states(const localization::PatchStates& states,
                         const localization::ParticleSet& particles, std::size_t begin,
                         std::size_t end) {
  const bool is_sampled = states.memory() == PatchMemory::kNone;
  return {std::span(particles.submap).subspan(begin, end - begin),
          std::span(particles.configuration).subspan(begin, is_sampled ? end - begin : 0)};
}

BeliefRows belief_rows(const localization::PatchStates& states,
                       const localization::ParticleSet& particles, std::size_t begin) {
  const std::size_t columns = states.columns();
  switch (states.memory()) {
    case PatchMemory::kNone:
      return {states.usual(particles).data(), columns, 0};
    case PatchMemory::kShared:
      return {particles.shared_belief.data(), columns, 0};
    case PatchMemory::kPerParticle:
      break;
  }
  return {particles.belief(begin).data(), columns, columns};
}

}  // namespace strata::patch_beams
